// A calibration for other programs: tables as CSV, parameters as their configuration files want them.
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/export_configurations.hpp"
#include "daemon/cli/export_formats.hpp"
#include "daemon/cli/outputs.hpp"
#include "daemon/cli/usable_calibration.hpp"
#include "daemon/cli/verbs.hpp"
#include "proto/file_bytes.hpp"

namespace odomcalib::cli {
namespace {

struct ExportOptions {
  std::string calibration, what = "parameters", out;
};

// The text of another program's format is one value of the JSON object.
void print_export(const std::string& what, const std::string& text, const Session& session) {
  if (session.json == JsonMode::off)
    std::cout << text;
  else
    print_document("export", {{"what", what}, {"text", text}}, session.json);
}

int export_calibration(const ExportOptions& options, const Session& session) {
  if (const auto files = check_outputs({{"--out", options.out}}, {{"the calibration", options.calibration}});
      !files)
    return report_error(files.error(), session.json);
  const bool configuration = is_configuration(options.what);
  const auto calibration =
      configuration ? read_finite_calibration(options.calibration) : read_calibration(options.calibration);
  if (!calibration) return report_error(calibration.error(), session.json);
  const auto text = exported(calibration.value(), options.what, options.calibration);
  if (!text) return report_error(text.error(), session.json);
  if (calibration.value().verdict == Verdict::refused)
    warn(refusal_of(calibration.value(), options.calibration).text());
  if (configuration)
    for (const std::string& sentence : not_held(calibration.value(), options.what)) warn(sentence);
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
  auto* verb = app.add_subcommand("export", "A calibration file for other programs: CSV, TOML, ros2_control");
  auto options = std::make_shared<ExportOptions>();
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
  verb->add_option("--out", options->out, "file to write instead of standard output");
  verb->callback([&session, options] {
    session.run = [&session, options] { return export_calibration(*options, session); };
  });
}

}  // namespace odomcalib::cli
