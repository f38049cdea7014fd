// A calibration file as a report, for who was not there when it was solved.
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "daemon/cli/calibration_summary.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/outputs.hpp"
#include "daemon/cli/report_page.hpp"
#include "daemon/cli/verbs.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/file_bytes.hpp"

namespace odomcalib::cli {
namespace {

struct ReportOptions {
  std::string calibration, html;
};

int show_report(const ReportOptions& options, const Session& session) {
  if (const auto files =
          check_outputs({{"--html", options.html}}, {{"the calibration", options.calibration}});
      !files)
    return report_error(files.error(), session.json);
  const auto calibration = read_calibration(options.calibration);
  if (!calibration) return report_error(calibration.error(), session.json);
  if (!options.html.empty())
    if (auto written = write_output(options.html, report_page(calibration.value())); !written)
      return report_error(written.error(), session.json);
  if (session.json != JsonMode::off)
    print_json(to_json(calibration.value()), session.json);
  else
    print_calibration(calibration.value(), session);
  return kDone;
}

}  // namespace

void add_report(CLI::App& app, Session& session) {
  auto* verb = app.add_subcommand("report", "A calibration file as text, JSON or HTML");
  auto options = std::make_shared<ReportOptions>();
  verb->add_option("CALIBRATION", options->calibration)->required();
  verb->add_option("--html,--out", options->html, "HTML page to write");
  verb->callback(
      [&session, options] { session.run = [&session, options] { return show_report(*options, session); }; });
}

}  // namespace odomcalib::cli
