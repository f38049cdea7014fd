// A calibration file as a report, for who was not there when it was solved.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>

#include "daemon/cli/calibration_summary.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/outputs.hpp"
#include "daemon/cli/report_page.hpp"
#include "daemon/cli/report_sheets.hpp"
#include "daemon/cli/usable_calibration.hpp"
#include "daemon/cli/verbs.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/file_bytes.hpp"

namespace odomcalib::cli {
namespace {

struct ReportOptions {
  std::string calibration, html, sheet, certificate;
};

/// Nothing is certified that may not be used, or that cannot be read back to the same bytes.
Result<void> write_certificate(const Calibration& calibration, const ReportOptions& options) {
  if (calibration.verdict == Verdict::refused) return refusal_of(calibration, options.calibration);
  const auto bytes = read_file_bytes(options.calibration);
  if (!bytes) return bytes.error();
  const std::string name = std::filesystem::path(options.calibration).filename().string();
  return write_output(options.certificate, certificate(calibration, name, sha256_hex(bytes.value())));
}

Result<void> write_pages(const Calibration& calibration, const ReportOptions& options) {
  if (!options.html.empty())
    if (auto written = write_output(options.html, report_page(calibration)); !written) return written;
  if (!options.sheet.empty())
    if (auto written = write_output(options.sheet, mechanics_sheet(calibration)); !written) return written;
  if (!options.certificate.empty()) return write_certificate(calibration, options);
  return {};
}

int show_report(const ReportOptions& options, const Session& session) {
  if (const auto files = check_outputs(
          {{"--html", options.html}, {"--sheet", options.sheet}, {"--certificate", options.certificate}},
          {{"the calibration", options.calibration}});
      !files)
    return report_error(files.error(), session.json);
  const auto calibration = read_calibration(options.calibration);
  if (!calibration) return report_error(calibration.error(), session.json);
  if (auto written = write_pages(calibration.value(), options); !written)
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
  verb->add_option("CALIBRATION", options->calibration, "file that solve or calibrate wrote")->required();
  verb->add_option("--html,--out", options->html, "HTML page to write");
  verb->add_option("--sheet", options->sheet, "page to write for the mechanic: what was found where");
  verb->add_option("--certificate", options->certificate,
                   "page to write that can be filed; not of a refusal");
  verb->callback(
      [&session, options] { session.run = [&session, options] { return show_report(*options, session); }; });
}

}  // namespace odomcalib::cli
