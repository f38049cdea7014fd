// Waits for the daemon: until everything for a motion is there, or until nothing runs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "daemon/cli/client.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/options.hpp"
#include "daemon/cli/settings.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;

struct WaitOptions {
  std::string until = "ready";
  double timeout = settings::kUsualWait_s;
};

class Deadline {
 public:
  explicit Deadline(double seconds) : seconds_(seconds) {}
  [[nodiscard]] double elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }
  [[nodiscard]] bool over() const { return elapsed() >= seconds_; }
  /// Time that is left, at most so much.
  [[nodiscard]] std::chrono::milliseconds left(std::chrono::milliseconds most) const {
    const std::chrono::duration<double> rest(std::max(0.0, seconds_ - elapsed()));
    return std::min(most, std::chrono::ceil<std::chrono::milliseconds>(rest));
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double seconds_;
};

/// Member of the daemon's answer. Errors: those of the client; format, it has no such member.
Result<ordered_json> answer_of(Client& client, const char* method, const char* member,
                               const Deadline& deadline) {
  // Even the last look has the time that an answer takes: what it finds is what the error says.
  const auto within = std::max(settings::kLookAgain, deadline.left(settings::kAnswerOfDaemon));
  const auto answer = client.call(method, ordered_json::object(), static_cast<int>(within.count()));
  if (!answer) return answer.error();
  auto body = answer_with(answer.value(), method, member);
  if (!body) return body.error();
  return std::move(body).value()[member];
}

/// Missing conditions, in words for people; empty: none. Errors: those of the client.
Result<std::string> missing_for(const std::string& socket, bool ready, const Deadline& deadline) {
  auto client = Client::connect(socket);
  if (!client) return client.error();
  const auto status = answer_of(client.value(), "GetStatus", "status", deadline);
  if (!status) return status.error();
  const std::string state = status.value().value("state", "");
  std::string missing = state == "idle" ? "" : "odomcalibd: " + state;
  if (!ready) return missing;
  const auto checks = answer_of(client.value(), "Check", "checks", deadline);
  if (!checks) return checks.error();
  for (const auto& check : checks.value())
    if (stands_in_the_way(check))
      missing +=
          (missing.empty() ? "" : "; ") + check.value("name", "a check") + ": " + check.value("found", "");
  return missing;
}

/// Nobody has answered: the daemon does not run, or does not get to it.
bool silent(const Error& error) {
  return error.code == ErrorCode::not_running || error.code == ErrorCode::timeout;
}

Error too_late(const WaitOptions& options, const std::string& missing) {
  return {ErrorCode::timeout, fmt::format("not {} after {:g} s: {}", options.until, options.timeout, missing),
          "odomcalibd", "odomcalibctl check"};
}

int wait_for(const WaitOptions& options, const Session& session) {
  const Deadline deadline(options.timeout);
  bool answered = false;
  std::string said;
  for (;;) {
    const auto missing = missing_for(session.socket, options.until == "ready", deadline);
    if (missing && missing.value().empty()) {
      if (session.json != JsonMode::off)
        print_document("wait", {{"until", options.until}, {"seconds", deadline.elapsed()}}, session.json);
      return kDone;
    }
    if (!missing && missing.error().code == ErrorCode::not_permitted)
      return report_error(missing.error(), session.json);
    answered = answered || missing || !silent(missing.error());
    const std::string now = missing ? missing.value() : missing.error().what;
    if (deadline.over() && answered) return report_error(too_late(options, now), session.json);
    if (deadline.over())
      return report_error({ErrorCode::not_running, now, session.socket, missing.error().remedy},
                          session.json);
    if (now != said) tell("waiting: " + now);
    said = now;
    std::this_thread::sleep_for(deadline.left(settings::kLookAgain));
  }
}

}  // namespace

void add_wait(CLI::App& app, Session& session) {
  const auto [wait, options] =
      add_verb(app, session, "wait", "Wait until the daemon is ready for a motion, or idle", wait_for);
  wait->add_option("--until", options->until,
                   "ready: nothing that check looks at fails, and nothing runs; idle: nothing runs")
      ->check(CLI::IsMember({"ready", "idle"}))
      ->capture_default_str();
  wait->add_option("--timeout", options->timeout, "s")
      ->check(finite(0.0, settings::kLongestWait_s))
      ->capture_default_str();
}

}  // namespace odomcalib::cli
