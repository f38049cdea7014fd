// Recording without motion: for a time, or until Ctrl-C or `odomcalibctl stop`.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "daemon/cli/client.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/interrupts.hpp"
#include "daemon/cli/options.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;

struct RecordOptions {
  std::string name = "record";
  double duration = 0.0;
};

void show_progress(const control::Reply& reply, ProgressLine& line) {
  const auto body = ordered_json::parse(reply.parameters, nullptr, false);
  const auto eta = body.is_object() && body.contains("progress")
                       ? body["progress"].value("eta", ordered_json())
                       : ordered_json();
  line.show(eta.is_number() ? fmt::format("recording, {:.0f} s left", eta.get<double>())
                            : "recording; Ctrl-C ends it");
}

// Ends when the daemon says where the recording is.
Result<std::string> await_path(Client& client, const std::string& socket) {
  ProgressLine line;
  for (bool told = false;;) {
    if (interrupted() && !told) {
      auto other = Client::connect(socket);
      if (!other) return other.error();
      if (auto stopped = other.value().call("Stop"); !stopped) return stopped.error();
      told = true;
    }
    const auto reply = client.receive(100);
    if (!reply) return reply.error();
    if (!reply.value()) continue;
    if (!reply.value()->error.empty()) return control::error_of(*reply.value());
    if (!reply.value()->continues) return reply.value()->parameters;
    show_progress(*reply.value(), line);
  }
}

int record(const RecordOptions& options, const Session& session) {
  finish_when_interrupted();
  auto client = Client::connect(session.socket);
  if (!client) return report_error(client.error(), session.json);
  const ordered_json wanted = {{"name", options.name}, {"duration", options.duration}};
  if (auto sent = client.value().send("Record", wanted, true); !sent)
    return report_error(sent.error(), session.json);
  const auto answer = await_path(client.value(), session.socket);
  if (!answer) return report_error(answer.error(), session.json);
  if (session.json != JsonMode::off)
    print_document("record", ordered_json::parse(answer.value(), nullptr, false), session.json);
  else
    std::cout << ordered_json::parse(answer.value(), nullptr, false).value("path", "") << '\n';
  return kDone;
}

}  // namespace

void add_record(CLI::App& app, Session& session) {
  const auto [verb, options] =
      add_verb(app, session, "record", "Record without moving the robot, until Ctrl-C or for a time", record);
  verb->add_option("NAME", options->name, "beginning of the file's name")->capture_default_str();
  verb->add_option("--duration", options->duration, "s, 0: until Ctrl-C or stop")->check(finite(0.0, 3600.0));
}

}  // namespace odomcalib::cli
