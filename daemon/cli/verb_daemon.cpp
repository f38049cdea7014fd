// Verbs that ask the daemon and print its answer.
#include <fmt/format.h>
#include <pwd.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "daemon/cli/client.hpp"
#include "daemon/cli/document.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/parameter_tables.hpp"
#include "daemon/cli/verbs.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;
using Printer = std::function<void(const ordered_json&, const Session&)>;

std::string text_of(const ordered_json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// What is asked, and what the answer is printed as.
struct Question {
  std::string method;
  std::string member;    ///< of the answer that is printed; empty: all of it
  std::string document;  ///< of the answer
  Printer print;
};

/// The state is a document by itself: its members are those of the answer's only one.
ordered_json document_of(const ordered_json& answer, const Question& question) {
  return question.document == "status" ? answer.value(question.member, ordered_json::object()) : answer;
}

/// A check that fails is a failure of the command; everything else is answered.
int status_of(const ordered_json& body, const Question& question) {
  if (question.document != "checks") return kDone;
  for (const auto& check : body.value(question.member, ordered_json::array()))
    if (check.value("outcome", "") == "fail") return kFailure;
  return kDone;
}

/// The daemon knows numbers only: a directory service may take its time.
void name_users(ordered_json& entries) {
  for (auto& entry : entries) {
    if (!entry.is_object() || !entry.contains("user") || !entry["user"].is_number_unsigned()) continue;
    const passwd* const user = getpwuid(entry["user"].get<uid_t>());
    if (user != nullptr) entry["user_name"] = user->pw_name;
  }
}

int ask(const Session& session, const Question& question) {
  auto client = Client::connect(session.socket);
  if (!client) return report_error(client.error(), session.json);
  const auto answer = client.value().call(question.method);
  if (!answer) return report_error(answer.error(), session.json);
  auto body = ordered_json::parse(answer.value(), nullptr, false);
  if (question.document == "history") name_users(body[question.member]);
  if (session.json != JsonMode::off)
    print_document(question.document, document_of(body, question), session.json);
  else
    question.print(question.member.empty() ? body : body.value(question.member, ordered_json()), session);
  return status_of(body, question);
}

/// Of a recording: what it holds of each kind of motion, and what a solve would miss.
std::vector<std::vector<std::string>> motion_rows(const ordered_json& motion) {
  const auto degrees = [&](const char* way) {
    return fmt::format("{} {} ({:.0f} deg)", motion[way]["stretches"].get<int>(), way,
                       motion[way]["rad"].get<double>() * 180.0 / std::numbers::pi);
  };
  std::vector<std::vector<std::string>> rows = {
      {"recorded",
       fmt::format("stretches: {} straight ({:.2f} m), {}, {}", motion["straight"]["stretches"].get<int>(),
                   motion["straight"]["m"].get<double>(), degrees("left"), degrees("right"))}};
  for (const auto& missing : motion["missing"]) rows.push_back({"missing for a solve", text_of(missing)});
  return rows;
}

/// Whether what was written last was proven by a motion belongs to it.
std::string calibrated_text(const ordered_json& status) {
  std::string calibrated = status["calibrated"] == true ? "yes" : "no";
  if (!status.contains("proven") || !status["proven"].is_boolean()) return calibrated;
  return calibrated +
         (status["proven"] == true ? ", proven by a motion" : "; what was written last is unproven");
}

void print_status(const ordered_json& status, const Session& session) {
  Document document{"odomcalibd: " + text_of(status["state"]), {}};
  const auto& controller = status["controller"];
  const auto& lidar = status["lidar"];
  Section section;
  section.table.rows = {{"controller", text_of(controller["state"]) + "  " + text_of(controller["device"])},
                        {"lidar", (lidar["stale"] == "" ? "scans arrive" : text_of(lidar["stale"])) + "  " +
                                      text_of(lidar["device"])},
                        {"calibrated", calibrated_text(status)},
                        {"last stop", text_of(status["last_stop"])}};
  if (status["recording_bytes"] > 0)
    for (auto& row : motion_rows(status["recorded_motion"])) section.table.rows.push_back(std::move(row));
  for (const auto* device : {&controller, &lidar})
    if ((*device)["problem"] != "") section.lines.push_back(text_of((*device)["problem"]));
  if (status.value("replaced_controller", "") != "")
    section.lines.push_back(status.value("replaced_controller", "") + ": odomcalibctl check");
  document.sections.push_back(section);
  print_text(document, session.legend);
}

void print_checks(const ordered_json& checks, const Session& session) {
  print_text(describe_checks(checks), session.legend);
}

void print_parameters(const ordered_json& parameters, const Session& session) {
  print_text(describe_parameters(parameters), session.legend);
}

void print_history(const ordered_json& entries, const Session& session) {
  print_text(describe_history(entries), session.legend);
}

void add_question(CLI::App& app, Session& session, const char* verb, const char* help,
                  const Question& question) {
  app.add_subcommand(verb, help)->callback([&session, question] {
    session.run = [&session, question] { return ask(session, question); };
  });
}

Question status_question() { return {"GetStatus", "status", "status", print_status}; }

}  // namespace

int show_status(const Session& session) { return ask(session, status_question()); }

int show_checks(const Session& session) { return ask(session, {"Check", "checks", "checks", print_checks}); }

void add_questions(CLI::App& app, Session& session) {
  add_question(app, session, "status", "What the daemon and its devices do (default)", status_question());
  add_question(app, session, "stop", "Stop the robot and whatever runs",
               {"Stop", "", "stop", [](const ordered_json&, const Session&) { std::cout << "stopped\n"; }});
  add_question(app, session, "history", "What was written to the controller",
               {"History", "entries", "history", print_history});
  auto* params = app.add_subcommand("params", "Parameters of the controller");
  params->require_subcommand(1);
  params->fallthrough();
  const Question parameters{"GetParameters", "parameters", "parameters", print_parameters};
  add_question(*params, session, "get", "Values in force", parameters);
  add_question(*params, session, "diff", "Values in force against calibrated ones", parameters);
}

}  // namespace odomcalib::cli
