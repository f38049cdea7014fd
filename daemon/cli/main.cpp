// odomcalibctl: parses the command line and runs one verb.
#include <CLI/CLI.hpp>
#include <exception>
#include <new>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/help.hpp"
#include "daemon/cli/interrupts.hpp"
#include "daemon/cli/verbs.hpp"
#include "daemon/config/large_pages.hpp"
#include "odomcalib_version.hpp"
#include "proto/near_miss.hpp"

namespace {

using odomcalib::cli::JsonMode;

void add_common_options(CLI::App& app, odomcalib::cli::Session& session, std::string& json) {
  app.add_flag("--json{pretty}", json, "print JSON: --json or --json=pretty|short|off")
      ->check(CLI::IsMember({"pretty", "short", "off"}));
  app.add_flag("--verbose", session.verbose, "everything about a calibration instead of a summary");
  app.add_flag("!--no-legend", session.legend, "tables without their head line");
  app.add_flag_callback(
      "--no-pager", [] {}, "accepted for scripts; no pager is ever started");
  app.set_version_flag("--version", odomcalib::kVersion);
  app.add_option("--socket", session.socket, "control socket of the daemon")->capture_default_str();
}

JsonMode mode_of(const std::string& text) {
  if (text == "short") return JsonMode::shortened;
  return text == "pretty" ? JsonMode::pretty : JsonMode::off;
}

// For what happens before the command line is parsed, or when it cannot be.
JsonMode asked_mode(int argc, char** argv) {
  const std::vector<std::string_view> words(argv, argv + argc);
  constexpr std::string_view kOption = "--json";
  for (const std::string_view word : words) {
    if (word == kOption) return JsonMode::pretty;
    if (word.starts_with("--json=")) return mode_of(std::string(word.substr(kOption.size() + 1)));
  }
  return JsonMode::off;
}

/// Verbs and long options that may stand where these words were found.
std::set<std::string> known_words(const CLI::App& app) {
  std::set<std::string> known;
  const auto any = [](const CLI::App*) { return true; };
  for (const CLI::App* verb : app.get_subcommands(any)) known.insert(verb->get_name());
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) known.insert("--" + name);
  for (const CLI::App* parsed : app.get_subcommands()) known.merge(known_words(*parsed));
  return known;
}

/// The known word that the first unknown one is nearest to, as a question; empty: none is near.
std::string suggestion(const CLI::App& app) {
  for (const std::string& word : app.remaining(true))
    if (const auto meant = odomcalib::near_miss(word.substr(0, word.find('=')), known_words(app)))
      return "did you mean \"" + *meant + "\"?";
  return "";
}

/// The help of the verb that was found.
std::string help_command(const CLI::App& app) {
  std::string command = "odomcalibctl";
  for (const CLI::App* at = &app; !at->get_subcommands().empty();) {
    at = at->get_subcommands().front();
    command += " " + at->get_name();
  }
  return "see " + command + " --help";
}

/// The option parser lists what it would take without a space, which no line could be broken at. What the
/// user typed stands in quotes, and stays.
std::string with_spaces(const std::string& list) {
  std::string out;
  bool quoted = false;
  for (std::size_t i = 0; i < list.size(); ++i) {
    out += list[i];
    if (list[i] == '"') quoted = !quoted;
    if (list[i] == ',' && !quoted && i + 1 < list.size() && list[i + 1] != ' ') out += ' ';
  }
  return out;
}

int refuse(const CLI::App& app, const CLI::ParseError& error, JsonMode json) {
  if (error.get_exit_code() == 0) return app.exit(error);
  const std::string meant = suggestion(app);
  return odomcalib::cli::report_error({odomcalib::ErrorCode::usage, with_spaces(error.what()), "command line",
                                       meant.empty() ? help_command(app) : meant},
                                      json);
}

int run(int argc, char** argv) {
  CLI::App app{"Calibrates the odometry of differential-drive robots.", "odomcalibctl"};
  odomcalib::cli::Session session;
  std::string json = "off";
  odomcalib::cli::lay_out_help(app);
  add_common_options(app, session, json);
  app.fallthrough();
  app.require_subcommand(0, 1);
  odomcalib::cli::add_solve(app, session);
  odomcalib::cli::add_predict(app, session);
  odomcalib::cli::add_convert(app, session);
  odomcalib::cli::add_inspect(app, session);
  odomcalib::cli::add_decode(app, session);
  odomcalib::cli::add_match(app, session);
  odomcalib::cli::add_report(app, session);
  odomcalib::cli::add_compare(app, session);
  odomcalib::cli::add_export(app, session);
  odomcalib::cli::add_graph(app, session);
  odomcalib::cli::add_questions(app, session);
  odomcalib::cli::add_wait(app, session);
  odomcalib::cli::add_monitor(app, session);
  odomcalib::cli::add_view(app, session);
  odomcalib::cli::add_record(app, session);
  odomcalib::cli::add_manual(app, session);
  odomcalib::cli::add_motions(app, session);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return refuse(app, error, asked_mode(argc, argv));
  }
  session.json = mode_of(json);
  if (session.takes_much_memory) odomcalib::ask_for_large_pages(argv);
  if (session.run) return session.run();
  return odomcalib::cli::show_status(session);
}

}  // namespace

int main(int argc, char** argv) {
  const JsonMode json = asked_mode(argc, argv);
  const odomcalib::cli::VisibleStreams visible;
  odomcalib::cli::end_when_interrupted(json);
  int status = odomcalib::cli::kFailure;
  try {
    status = run(argc, argv);
  } catch (const std::bad_alloc&) {
    status = odomcalib::cli::report_error(
        {odomcalib::ErrorCode::io, "out of memory", "odomcalibctl", "give it less to read, or more memory"},
        json);
  } catch (const std::exception& error) {
    status = odomcalib::cli::report_error({odomcalib::ErrorCode::io, error.what(), "odomcalibctl", ""}, json);
  }
  return odomcalib::cli::after_flush(status);
}
