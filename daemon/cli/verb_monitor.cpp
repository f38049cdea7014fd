// Events in the daemon as they happen, and its state when it changes.
#include <fmt/chrono.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>

#include "daemon/cli/client.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/interrupts.hpp"
#include "daemon/cli/options.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;

struct MonitorOptions {
  double duration = 0.0;
};

const char* word_of(int severity) {
  constexpr std::array kWords = {"info", "warning", "stop", "fault"};
  return severity >= 0 && severity < static_cast<int>(kWords.size())
             ? kWords.at(static_cast<std::size_t>(severity))
             : "?";
}

void print_event(const ordered_json& event, const Session& session) {
  if (session.json != JsonMode::off) {
    std::cout << event.dump(-1, ' ', false, ordered_json::error_handler_t::replace)
              << std::endl;  // a line each
    return;
  }
  const auto seconds = static_cast<std::time_t>(event.value("time", std::int64_t{0}) / 1'000'000);
  print_line(fmt::format("{:%H:%M:%S}  {:<8}{:<18}{}", fmt::localtime(seconds),
                         word_of(event.value("severity", -1)), event.value("code", ""),
                         event.value("text", "")));
  std::cout << std::flush;
}

/// State of the daemon as an event, when it is another than before.
Result<void> watch_state(Client& client, std::string& last, const Session& session) {
  const auto answer = client.call("GetStatus");
  if (!answer) return answer.error();
  const std::string state = answer.value().value("status", ordered_json::object()).value("state", "");
  if (state == last) return {};
  last = state;
  const auto now = std::chrono::duration_cast<std::chrono::microseconds>(
      std::chrono::system_clock::now().time_since_epoch());
  print_event({{"time", now.count()}, {"severity", 0}, {"code", "state"}, {"text", state}}, session);
  return {};
}

int watch(Client& events, Client& questions, const MonitorOptions& options, const Session& session) {
  using Clock = std::chrono::steady_clock;
  if (auto sent = events.send("Monitor", ordered_json::object(), true); !sent)
    return report_error(sent.error(), session.json);
  const auto begin = Clock::now();
  auto next = begin;
  std::string state;
  while (!interrupted() && std::cout) {
    const auto now = Clock::now();
    if (options.duration > 0.0 && std::chrono::duration<double>(now - begin).count() >= options.duration)
      break;
    if (now >= next) {
      next = now + std::chrono::milliseconds(500);
      if (auto seen = watch_state(questions, state, session); !seen)
        return report_error(seen.error(), session.json);
    }
    const auto reply = events.receive(100);
    if (!reply) return report_error(reply.error(), session.json);
    if (!reply.value()) continue;
    if (!reply.value()->error.empty()) return report_error(control::error_of(*reply.value()), session.json);
    const auto body = ordered_json::parse(reply.value()->parameters, nullptr, false);
    if (body.is_object() && body.contains("event")) print_event(body["event"], session);
  }
  return kDone;
}

int monitor(const MonitorOptions& options, const Session& session) {
  finish_when_interrupted();
  auto events = Client::connect(session.socket);
  if (!events) return report_error(events.error(), session.json);
  auto questions = Client::connect(session.socket);
  if (!questions) return report_error(questions.error(), session.json);
  return watch(events.value(), questions.value(), options, session);
}

}  // namespace

void add_monitor(CLI::App& app, Session& session) {
  const auto [verb, options] =
      add_verb(app, session, "monitor", "Events of the daemon as they happen, until Ctrl-C", monitor);
  verb->add_option("--duration", options->duration, "s, 0: until Ctrl-C")->check(finite(0.0, 86400.0));
}

}  // namespace odomcalib::cli
