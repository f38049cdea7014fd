// A calibration for other programs: tables as CSV, parameters as their configuration files want them.
#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/export_configurations.hpp"
#include "daemon/cli/export_formats.hpp"
#include "daemon/cli/options.hpp"
#include "daemon/cli/settings.hpp"
#include "daemon/cli/text_edit.hpp"
#include "daemon/cli/usable_calibration.hpp"
#include "proto/file_bytes.hpp"

namespace odomcalib::cli {
namespace {

struct ExportOptions {
  std::string calibration, what = "parameters", out, into, link;
  bool yes = false;
};

// The text of another program's format is one value of the JSON object.
void print_export(const std::string& what, const std::string& text, const Session& session) {
  if (session.json == JsonMode::off)
    std::cout << text;
  else
    print_document("export", {{"what", what}, {"text", text}}, session.json);
}

void print_change(const ExportOptions& options, const std::string& diff, const Session& session) {
  if (session.json == JsonMode::off)
    std::cout << diff << std::flush;
  else
    print_document("export",
                   {{"what", options.what},
                    {"text", diff},
                    {"into", options.into},
                    {"kept", diff.empty() ? nlohmann::json() : nlohmann::json(kept_name(options.into))}},
                   session.json);
}

Result<OwnText> own_text(const ExportOptions& options) {
  auto text = read_file_bytes(options.into);
  if (!text) return text.error();
  if (text.value().size() > settings::kMostOwnFile_bytes)
    return Error{ErrorCode::format, "is too large for a configuration", options.into, "name another file"};
  return OwnText{options.into, std::move(text).value(), options.link};
}

/// Shows what changes, asks, and changes it. With JSON the object comes after, when it is done.
Result<void> change_file(const Calibration& calibration, const ExportOptions& options,
                         const Session& session) {
  const auto own = own_text(options);
  if (!own) return own.error();
  const auto edits = edits_of(calibration, options.what, own.value(), options.calibration);
  if (!edits) return edits.error();
  const std::string& text = own.value().text;
  const std::string diff = diff_of(options.into, text, edited(text, edits.value()));
  if (session.json == JsonMode::off) print_change(options, diff, session);
  if (diff.empty()) {
    tell(options.into + " holds these values already; nothing was written");
  } else {
    if (auto agreed = ask_to_change(options.into, options.yes); !agreed) return agreed;
    if (auto changed = change_own_file(options.into, text, edits.value()); !changed) return changed;
    tell("the old file is " + kept_name(options.into));
  }
  if (session.json != JsonMode::off) print_change(options, diff, session);
  return {};
}

Result<void> check_files(const ExportOptions& options) {
  if (!options.into.empty() && !options.out.empty())
    return Error{ErrorCode::usage, "--into changes a file, --out writes one", "--into", "give one of them"};
  if (!options.into.empty() && !goes_into_files(options.what))
    return Error{ErrorCode::usage, "--into takes diff_drive and urdf", "--what " + options.what,
                 "write it with --out"};
  if (!options.link.empty() && (options.into.empty() || options.what != "urdf"))
    return Error{ErrorCode::usage, "names a link of the URDF that --into changes", "--link",
                 "leave it out, or give --what urdf --into FILE"};
  return check_outputs({{"--out", options.out}, {"--into", options.into}},
                       {{"the calibration", options.calibration}});
}

int export_calibration(const ExportOptions& options, const Session& session) {
  if (const auto files = check_files(options); !files) return report_error(files.error(), session.json);
  const bool configuration = is_configuration(options.what);
  const auto calibration = configuration ? read_finite_calibration(options.calibration)
                                         : read_plausible_calibration(options.calibration);
  if (!calibration) return report_error(calibration.error(), session.json);
  const auto text = exported(calibration.value(), options.what, options.calibration);
  if (!text) return report_error(text.error(), session.json);
  if (calibration.value().verdict == Verdict::refused)
    warn(refusal_of(calibration.value(), options.calibration).text());
  if (configuration)
    for (const std::string& sentence : not_held(calibration.value(), options.what)) warn(sentence);
  if (!options.into.empty()) {
    const auto changed = change_file(calibration.value(), options, session);
    return changed ? kDone : report_error(changed.error(), session.json);
  }
  if (options.out.empty()) {
    print_export(options.what, text.value(), session);
    return kDone;
  }
  if (auto written = write_output(options.out, text.value()); !written)
    return report_error(written.error(), session.json);
  return kDone;
}

}  // namespace

void add_export(CLI::App& app, Session& session) {
  const auto [verb, options] =
      add_verb(app, session, "export", "A calibration file for other programs: CSV, TOML, ros2_control",
               export_calibration);
  verb->add_option("CALIBRATION", options->calibration, "file that solve or calibrate wrote")->required();
  verb->add_option(
          "--what", options->what,
          "CSV: parameters, effects, errors, residual, paths, traces; robot.toml: toml; parameters of "
          "ros2_control's diff_drive_controller: diff_drive; joint of the lidar: urdf; parameters of "
          "ros_arduino_bridge: ros_arduino; changes to ARCOS (Pioneer): arcos; odometry with all effects as "
          "one file "
          "of source: c_header, python; noise of odometry for filters: amcl, robot_localization, "
          "slam_toolbox")
      ->check(CLI::IsMember(export_formats()))
      ->capture_default_str();
  add_output(*verb, "--out", options->out, "file to write instead of standard output");
  verb->add_option(
      "--into", options->into,
      "file of your own to change, with diff_drive or urdf: shown and asked before; the old one is "
      "kept with a ~ behind its name");
  verb->add_option("--link", options->link,
                   "of the lidar in that URDF; default: the one with laser, lidar or scan in its name");
  verb->add_flag("--yes", options->yes, "change it without a question");
}

}  // namespace odomcalib::cli
