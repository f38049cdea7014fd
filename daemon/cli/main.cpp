// odomcalibctl: parses the command line and runs one verb.
#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/verbs.hpp"

namespace {

using odomcalib::cli::JsonMode;

void add_common_options(CLI::App& app, odomcalib::cli::Session& session, std::string& json) {
  app.add_flag("--json{pretty}", json, "print JSON: --json or --json=pretty|short|off")
      ->check(CLI::IsMember({"pretty", "short", "off"}));
  app.add_flag("!--no-legend", session.legend, "tables without their head line");
  app.add_flag_callback(
      "--no-pager", [] {}, "accepted for scripts; no pager is ever started");
  app.add_option("--socket", session.socket, "control socket of the daemon")->capture_default_str();
  app.footer(odomcalib::cli::exit_status_help());
}

JsonMode mode_of(const std::string& text) {
  if (text == "short") return JsonMode::shortened;
  return text == "pretty" ? JsonMode::pretty : JsonMode::off;
}

int run(int argc, char** argv) {
  CLI::App app{"Calibrates the odometry of differential-drive robots.", "odomcalibctl"};
  odomcalib::cli::Session session;
  std::string json = "off";
  add_common_options(app, session, json);
  app.fallthrough();
  app.require_subcommand(0, 1);
  odomcalib::cli::add_solve(app, session);
  odomcalib::cli::add_predict(app, session);
  odomcalib::cli::add_decode(app, session);
  odomcalib::cli::add_match(app, session);
  odomcalib::cli::add_report(app, session);
  odomcalib::cli::add_export(app, session);
  odomcalib::cli::add_graph(app, session);
  odomcalib::cli::add_questions(app, session);
  odomcalib::cli::add_monitor(app, session);
  odomcalib::cli::add_record(app, session);
  odomcalib::cli::add_motions(app, session);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? odomcalib::cli::kDone : odomcalib::cli::kUsage;
  }
  session.json = mode_of(json);
  if (session.run) return session.run();
  return odomcalib::cli::show_status(session);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "odomcalibctl: " << error.what() << '\n';
    return odomcalib::cli::kFailure;
  }
}
