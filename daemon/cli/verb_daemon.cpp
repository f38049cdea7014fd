// Verbs that ask the daemon and print its answer.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>
#include <vector>

#include "daemon/cli/answer_documents.hpp"
#include "daemon/cli/client.hpp"
#include "daemon/cli/document.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/parameter_tables.hpp"
#include "daemon/cli/verbs.hpp"
#include "daemon/cli/write_backs.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;
using Printer = std::function<void(const ordered_json&, const Session&)>;

/// A call, and the form in which its answer is printed.
struct Question {
  std::string method;
  std::string member;    ///< of the answer that is printed; empty: all of it
  std::string document;  ///< of the answer
  Printer print;

  /// Member without which the answer is none.
  [[nodiscard]] std::string needed() const { return document == "history" ? "entries" : member; }
};

/// The state is a document by itself: its members are those of the answer's only one.
ordered_json document_of(const ordered_json& answer, const Question& question) {
  return question.document == "status" ? answer.value(question.member, ordered_json::object()) : answer;
}

/// A check that fails is a failure of the command; everything else is answered.
int status_of(const ordered_json& body, const Question& question) {
  if (question.document != "checks") return kDone;
  for (const auto& check : body.value(question.member, ordered_json::array()))
    if (stands_in_the_way(check)) return kFailure;
  return kDone;
}

int ask(const Session& session, const Question& question) {
  auto answer = call_once(session.socket, question.method);
  if (!answer) return report_error(answer.error(), session.json);
  auto known = answer_with(std::move(answer).value(), question.method, question.needed());
  if (!known) return report_error(known.error(), session.json);
  ordered_json body = std::move(known).value();
  if (question.document == "history") name_users(body["entries"]);
  if (session.json != JsonMode::off)
    print_document(question.document, document_of(body, question), session.json);
  else
    question.print(question.member.empty() ? body : body.value(question.member, ordered_json()), session);
  return status_of(body, question);
}

void print_status(const ordered_json& status, const Session& session) {
  print_text(describe_status(status), session.legend);
}

void print_checks(const ordered_json& checks, const Session& session) {
  print_text(describe_checks(checks), session.legend);
}

void print_parameters(const ordered_json& parameters, const Session& session) {
  print_text(describe_parameters(parameters), session.legend);
}

void print_history(const ordered_json& answer, const Session& session) {
  std::vector<WriteBack> entries;
  const auto bodies = answer.value("entries", ordered_json::array());
  for (const auto& body : bodies)
    if (auto entry = write_back_from(body)) entries.push_back(std::move(*entry));
  print_text(describe_history(entries, bodies.size() - entries.size()), session.legend);
  const std::string folder = answer.value("calibrations", "");
  if (!folder.empty())
    print_line("What changed between the calibrations of this robot: odomcalibctl compare " + folder +
               "/*.json");
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
               {"History", "", "history", print_history});
  auto* params = app.add_subcommand("params", "Parameters of the controller");
  params->require_subcommand(1);
  params->fallthrough();
  const Question parameters{"GetParameters", "parameters", "parameters", print_parameters};
  add_question(*params, session, "get", "Values in force", parameters);
  add_question(*params, session, "diff", "Values in force against calibrated ones", parameters);
}

}  // namespace odomcalib::cli
