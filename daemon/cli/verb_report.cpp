// A calibration file as a report, for who was not there when it was solved.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>

#include "daemon/cli/calibration_summary.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/options.hpp"
#include "daemon/cli/parameter_tables.hpp"
#include "daemon/cli/report_page.hpp"
#include "daemon/cli/report_sheets.hpp"
#include "daemon/cli/usable_calibration.hpp"
#include "daemon/cli/write_backs.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/file_bytes.hpp"

namespace odomcalib::cli {
namespace {

struct ReportOptions {
  std::string calibration, html, sheet, certificate, history;
};

/// Sections on the write-backs of the calibration's robot. A history that was named must be readable; that of
/// this machine need not be.
Result<std::vector<Section>> written_sections(const Calibration& calibration, const ReportOptions& options,
                                              const Session& session) {
  const bool is_shown = !options.html.empty() || (session.verbose && session.json == JsonMode::off);
  if (!is_shown && !options.history.empty())
    return Error{ErrorCode::usage, "--history has its place on the page and in the whole text", "--history",
                 "add --html PAGE or --verbose"};
  if (!is_shown) return std::vector<Section>();
  const auto entries =
      options.history.empty() ? history_of_this_machine(session.socket) : read_history(options.history);
  if (!entries) return entries.error();
  const auto own = entries_of_robot(entries.value(), calibration);
  if (own.empty() && !options.history.empty())
    warn(options.history + ": no write-back of this calibration or its robot");
  return write_back_sections(own, digest_in_history(calibration));
}

/// Nothing is certified that may not be used, or that cannot be read back to the same bytes.
Result<void> write_certificate(const Calibration& calibration, const ReportOptions& options) {
  if (calibration.verdict == Verdict::refused) return refusal_of(calibration, options.calibration);
  const auto bytes = read_file_bytes(options.calibration);
  if (!bytes) return bytes.error();
  const std::string name = std::filesystem::path(options.calibration).filename().string();
  return write_output(options.certificate, certificate(calibration, name, sha256_hex(bytes.value())));
}

Result<void> write_pages(const Calibration& calibration, const ReportOptions& options,
                         const std::vector<Section>& write_backs) {
  if (!options.html.empty())
    if (auto written = write_output(options.html, report_page(calibration, write_backs)); !written)
      return written;
  if (!options.sheet.empty())
    if (auto written = write_output(options.sheet, mechanics_sheet(calibration)); !written) return written;
  if (!options.certificate.empty()) return write_certificate(calibration, options);
  return {};
}

int show_report(const ReportOptions& options, const Session& session) {
  if (const auto files = check_outputs(
          {{"--html", options.html}, {"--sheet", options.sheet}, {"--certificate", options.certificate}},
          {{"the calibration", options.calibration}, {"the history", options.history}});
      !files)
    return report_error(files.error(), session.json);
  const auto calibration = read_sound_calibration(options.calibration);
  if (!calibration) return report_error(calibration.error(), session.json);
  const auto write_backs = written_sections(calibration.value(), options, session);
  if (!write_backs) return report_error(write_backs.error(), session.json);
  if (auto written = write_pages(calibration.value(), options, write_backs.value()); !written)
    return report_error(written.error(), session.json);
  if (session.json != JsonMode::off)
    print_json(to_json(calibration.value()), session.json);
  else
    print_calibration(calibration.value(), session, write_backs.value());
  return kDone;
}

}  // namespace

void add_report(CLI::App& app, Session& session) {
  const auto [verb, options] =
      add_verb(app, session, "report", "A calibration file as text, JSON or HTML", show_report);
  verb->add_option("CALIBRATION", options->calibration, "file that solve or calibrate wrote")->required();
  add_output(*verb, "--html,--out", options->html, "HTML page to write");
  add_output(*verb, "--sheet", options->sheet, "page to write for the mechanic: what was found where");
  add_output(*verb, "--certificate", options->certificate,
             "page to write that can be filed; not of a refusal");
  verb->add_option("--history", options->history,
                   "what was written to the controller, for page and --verbose: output of history --json, or "
                   "the service's state folder; default: what the service here says");
}

}  // namespace odomcalib::cli
