// A calibration for other programs: tables as CSV, parameters as their configuration files want them.
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/export_formats.hpp"
#include "daemon/cli/verbs.hpp"
#include "proto/file_bytes.hpp"

namespace odomcalib::cli {
namespace {

struct Options {
  std::string calibration, what = "parameters", out;
};

int export_calibration(const Options& options, const Session& session) {
  const auto calibration = read_calibration(options.calibration);
  if (!calibration) return report_error(calibration.error(), session.json);
  const auto text = exported(calibration.value(), options.what);
  if (!text) return report_error(text.error(), session.json);
  if (options.out.empty()) {
    std::cout << text.value();
    return kDone;
  }
  if (auto written = replace_file(options.out, text.value()); !written)
    return report_error(written.error(), session.json);
  return kDone;
}

}  // namespace

void add_export(CLI::App& app, Session& session) {
  auto* verb = app.add_subcommand("export", "A calibration file for other programs: CSV, TOML, ros2_control");
  auto options = std::make_shared<Options>();
  verb->add_option("CALIBRATION", options->calibration)->required();
  verb->add_option(
          "--what", options->what,
          "CSV: parameters, effects, errors, residual, paths, traces; robot.toml: toml; parameters of "
          "ros2_control's diff_drive_controller: diff_drive")
      ->check(CLI::IsMember(export_formats()))
      ->capture_default_str();
  verb->add_option("--out", options->out, "file to write instead of standard output");
  verb->callback([&session, options] {
    session.run = [&session, options] { return export_calibration(*options, session); };
  });
}

}  // namespace odomcalib::cli
