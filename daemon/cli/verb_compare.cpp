// Calibrations of one robot against each other, or the newest of each robot of a fleet.
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "daemon/cli/comparison_document.hpp"
#include "daemon/cli/exit_codes.hpp"
#include "daemon/cli/options.hpp"
#include "daemon/cli/usable_calibration.hpp"
#include "proto/file_bytes.hpp"

namespace odomcalib::cli {
namespace {

struct CompareArguments {
  std::vector<std::string> files;
  std::string by, until, csv, html;
  bool trend = false;
};

Result<ComparisonOptions> options_of(const CompareArguments& arguments) {
  ComparisonOptions options{!arguments.by.empty(), arguments.trend, std::nullopt};
  if (arguments.until.empty()) return options;
  const auto bound = error_of_metre_from_text(arguments.until);
  if (!bound) return bound.error();
  options.bound = bound.value();
  options.trend = true;
  return options;
}

Result<std::vector<ComparedFile>> read_calibrations(const std::vector<std::string>& paths) {
  std::vector<ComparedFile> files;
  for (const std::string& path : paths) {
    auto calibration = read_plausible_calibration(path);
    if (!calibration) return calibration.error();
    files.push_back({path, std::move(calibration).value()});
  }
  return files;
}

Result<void> write_pages(const CompareArguments& arguments, const std::vector<ComparedRobot>& robots,
                         const ComparisonOptions& options) {
  if (!arguments.csv.empty())
    if (auto written = write_output(arguments.csv, to_csv(robots)); !written) return written;
  if (arguments.html.empty()) return {};
  return write_output(arguments.html, page_of(describe(robots, options, Extent::page)));
}

int compare_files(const CompareArguments& arguments, const Session& session) {
  const auto outputs = check_outputs({{"--csv", arguments.csv}, {"--html", arguments.html}},
                                     named("a calibration", arguments.files));
  if (!outputs) return report_error(outputs.error(), session.json);
  const auto options = options_of(arguments);
  if (!options) return report_error(options.error(), session.json);
  auto files = read_calibrations(arguments.files);
  if (!files) return report_error(files.error(), session.json);
  const auto robots = compare(std::move(files).value(), options.value());
  if (!robots) return report_error(robots.error(), session.json);
  if (auto written = write_pages(arguments, robots.value(), options.value()); !written)
    return report_error(written.error(), session.json);
  if (session.json == JsonMode::off)
    print_text(describe(robots.value(), options.value(), session.verbose ? Extent::steps : Extent::summary),
               session.legend);
  else
    print_document("comparison", to_json(robots.value(), options.value()), session.json);
  return kDone;
}

}  // namespace

void add_compare(CLI::App& app, Session& session) {
  const auto [verb, options] =
      add_verb(app, session, "compare", "What changed between calibrations of one robot; a fleet as a table",
               compare_files);
  verb->add_option("CALIBRATION", options->files, "files that solve wrote, of different drives")->required();
  verb->add_option("--by", options->by, "robot: a line a robot, the most urgent first")
      ->check(CLI::IsMember({"robot"}));
  verb->add_flag("--trend", options->trend, "a line through the values over date and distance");
  verb->add_option("--until", options->until,
                   "when the error of a metre passes this, as the trend goes on: 5mm/m or 0.5%");
  add_output(*verb, "--csv", options->csv, "CSV to write: each value, and its change since the one before");
  add_output(*verb, "--html", options->html, "page to write, with a picture of each parameter");
}

}  // namespace odomcalib::cli
