#include "daemon/cli/calibration_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <iterator>
#include <vector>

#include "daemon/cli/calibration_document.hpp"
#include "daemon/cli/left_out_lines.hpp"
#include "daemon/cli/report_sections.hpp"
#include "daemon/cli/settings.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::cli {
namespace {

/// The last line is what to do next.
std::vector<std::string> first_reasons(std::vector<std::string> lines, std::size_t most) {
  const std::size_t reasons = lines.size() - 1;
  if (reasons <= most) return lines;
  lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(most), lines.end() - 1);
  lines.insert(lines.end() - 1, fmt::format("and {} more: --verbose", reasons - most));
  return lines;
}

}  // namespace

std::string summary(const Calibration& calibration, bool legend, std::size_t width) {
  constexpr std::size_t kVerdict = 0, kValues = 3, kEffects = 5;
  Document document{headline(calibration.verdict),
                    {verdict_section(calibration),
                     gain_section(calibration),
                     {"", left_out_lines(calibration), {}},
                     parameters_section(calibration),
                     drive_errors_section(calibration, report_data_of(calibration), false),
                     effects_section(calibration),
                     {"", {"All of it: --verbose; as a page: odomcalibctl report FILE --html PAGE"}, {}}}};
  const auto text = [&] {
    Document shown{document.headline, {}};
    std::copy_if(document.sections.begin(), document.sections.end(), std::back_inserter(shown.sections),
                 [](const Section& one) { return !one.lines.empty() || !one.table.rows.empty(); });
    return to_text(shown, legend, width);
  };
  const auto too_long = [](const std::string& one) {
    return std::count(one.begin(), one.end(), '\n') > settings::kSummaryLines;
  };
  std::string out = text();
  for (const std::size_t remarks : {kValues, kEffects}) {
    if (!too_long(out)) return out;
    document.sections[remarks].lines.clear();
    out = text();
  }
  const std::vector<std::string> reasons = document.sections[kVerdict].lines;
  for (std::size_t most = settings::kSummaryReasons; most > 0 && too_long(out); --most) {
    document.sections[kVerdict].lines = first_reasons(reasons, most);
    out = text();
  }
  return out;
}

void print_calibration(const Calibration& calibration, const Session& session,
                       const std::vector<Section>& written) {
  if (session.verbose)
    print_text(describe(calibration, written), session.legend);
  else
    std::cout << summary(calibration, session.legend, text_columns());
}

}  // namespace odomcalib::cli
