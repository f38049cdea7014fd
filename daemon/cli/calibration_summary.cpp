#include "daemon/cli/calibration_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <utility>
#include <vector>

#include "daemon/cli/calibration_document.hpp"
#include "daemon/cli/report_sections.hpp"
#include "daemon/cli/settings.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::cli {
namespace {

/// What gives way, one after the other.
enum class Brevity { none, no_remarks_on_values, no_remarks_on_effects, few_reasons };
constexpr std::array kBrevities = {Brevity::none, Brevity::no_remarks_on_values,
                                   Brevity::no_remarks_on_effects, Brevity::few_reasons};

/// The last line is what to do next.
void leave_first_reasons(std::vector<std::string>& lines) {
  const std::size_t reasons = lines.size() - 1;
  if (reasons <= settings::kSummaryReasons) return;
  const auto begin = lines.begin() + static_cast<std::ptrdiff_t>(settings::kSummaryReasons);
  lines.erase(begin, lines.end() - 1);
  lines.insert(lines.end() - 1, fmt::format("and {} more: --verbose", reasons - settings::kSummaryReasons));
}

Document summary_document(const Calibration& calibration, Brevity brevity) {
  Section verdict = verdict_section(calibration);
  Section values = parameters_section(calibration), effects = effects_section(calibration);
  if (brevity >= Brevity::no_remarks_on_values) values.lines.clear();
  if (brevity >= Brevity::no_remarks_on_effects) effects.lines.clear();
  if (brevity >= Brevity::few_reasons) leave_first_reasons(verdict.lines);
  Document document{headline(calibration.verdict), {}};
  for (Section& section : std::vector<Section>{
           std::move(verdict), std::move(values), drive_errors_section(report_data_of(calibration), false),
           std::move(effects),
           Section{"", {"All of it: --verbose; as a page: odomcalibctl report FILE --html PAGE"}, {}}})
    if (!section.lines.empty() || !section.table.rows.empty())
      document.sections.push_back(std::move(section));
  return document;
}

}  // namespace

std::string summary(const Calibration& calibration, bool legend, std::size_t width) {
  std::string text;
  for (const Brevity brevity : kBrevities) {
    text = to_text(summary_document(calibration, brevity), legend, width);
    if (std::count(text.begin(), text.end(), '\n') <= settings::kSummaryLines) break;
  }
  return text;
}

void print_calibration(const Calibration& calibration, const Session& session) {
  if (session.verbose)
    print_text(describe(calibration), session.legend);
  else
    std::cout << summary(calibration, session.legend, text_columns());
}

}  // namespace odomcalib::cli
