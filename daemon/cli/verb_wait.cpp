// Waits for the daemon: until everything for a motion is there, or until nothing runs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "daemon/cli/client.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/settings.hpp"
#include "daemon/cli/verbs.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

struct Options {
  std::string until = "ready";
  double timeout = 30.0;  // s
};

/// Member of the daemon's answer; null where it has none.
Result<ordered_json> answer_of(Client& client, const char* method, const char* member) {
  const auto answer = client.call(method);
  if (!answer) return answer.error();
  const auto body = ordered_json::parse(answer.value(), nullptr, false);
  return body.is_object() ? body.value(member, ordered_json()) : ordered_json();
}

/// What is missing, for people; empty: nothing. Errors: those of the client.
Result<std::string> missing_for(const std::string& socket, bool ready) {
  auto client = Client::connect(socket);
  if (!client) return client.error();
  const auto status = answer_of(client.value(), "GetStatus", "status");
  if (!status) return status.error();
  const std::string state = status.value().is_object() ? status.value().value("state", "") : "";
  std::string missing = state == "idle" ? "" : "odomcalibd: " + state;
  if (!ready) return missing;
  const auto checks = answer_of(client.value(), "Check", "checks");
  if (!checks) return checks.error();
  for (const auto& check : checks.value())
    if (check.value("outcome", "") == "fail")
      missing += (missing.empty() ? "" : "; ") + check.value("name", "") + ": " + check.value("found", "");
  return missing;
}

int wait_for(const Session& session, const Options& options) {
  const auto begin = Clock::now();
  const auto elapsed = [begin] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  std::string said;
  for (;;) {
    const auto missing = missing_for(session.socket, options.until == "ready");
    if (missing && missing.value().empty()) {
      if (session.json != JsonMode::off)
        print_document("wait", {{"until", options.until}, {"seconds", elapsed()}}, session.json);
      return kDone;
    }
    const bool for_good = !missing && missing.error().code == ErrorCode::not_permitted;
    if (for_good || (!missing && elapsed() >= options.timeout))
      return report_error(missing.error(), session.json);
    const std::string now = missing ? missing.value() : missing.error().what;
    if (elapsed() >= options.timeout)
      return report_error(
          {ErrorCode::timeout, fmt::format("not {} after {:g} s: {}", options.until, options.timeout, now),
           "odomcalibd", "odomcalibctl check"},
          session.json);
    if (now != said) tell("waiting: " + now);
    said = now;
    std::this_thread::sleep_for(settings::kLookAgain);
  }
}

}  // namespace

void add_wait(CLI::App& app, Session& session) {
  auto options = std::make_shared<Options>();
  auto* wait = app.add_subcommand("wait", "Wait until the daemon is ready for a motion, or idle");
  wait->add_option("--until", options->until,
                   "ready: nothing that check looks at fails, and nothing runs; idle: nothing runs")
      ->check(CLI::IsMember({"ready", "idle"}))
      ->capture_default_str();
  wait->add_option("--timeout", options->timeout, "s")
      ->check(CLI::Range(0.0, settings::kLongestWait_s))
      ->capture_default_str();
  wait->callback(
      [&session, options] { session.run = [&session, options] { return wait_for(session, *options); }; });
}

}  // namespace odomcalib::cli
