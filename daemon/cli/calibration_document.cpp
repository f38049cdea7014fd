#include "daemon/cli/calibration_document.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>
#include <string_view>
#include <utility>

#include "calib/odometry/correction.hpp"
#include "daemon/cli/display.hpp"
#include "daemon/cli/export_configurations.hpp"
#include "daemon/cli/left_out_lines.hpp"
#include "daemon/cli/plain_words.hpp"
#include "daemon/cli/report_sections.hpp"
#include "proto/base_quantities.hpp"
#include "proto/calibration/scale.hpp"
#include "proto/calibration/utc.hpp"

namespace odomcalib::cli {
namespace {

std::optional<double> nominal_of(const RobotDescription& robot, const std::string& name) {
  const auto quantity = base_quantity_from(name);
  return quantity ? nominal_value(robot, *quantity) : std::nullopt;
}

std::string twice(double deviation, const Display& show) {
  return deviation >= 0.0 ? number(2.0 * deviation * show.factor, show.digits) : "-";
}

std::vector<std::string> parameter_row(const RobotDescription& robot, const std::string& name,
                                       const Quantity& quantity, const std::optional<Scale>& scale) {
  const Display show = display_of(quantity.unit);
  const auto nominal = nominal_of(robot, name);
  std::vector<std::string> row{readable(name), nominal ? number(*nominal * show.factor, show.digits) : "-",
                               number(quantity.value * show.factor, show.digits), twice(quantity.std, show)};
  if (scale) row.push_back(twice(absolute_deviation(quantity, *scale), show));
  row.push_back(show.unit);
  const bool relative = nominal && *nominal != 0.0 && is_drive_length(name);
  row.push_back(relative ? fmt::format("{:+.3f} %", 100.0 * (quantity.value / *nominal - 1.0)) : "");
  return row;
}

const Quantity* find(const QuantityList& list, const std::string& name) {
  for (const auto& [key, quantity] : list)
    if (key == name) return &quantity;
  return nullptr;
}

std::string quantity_cell(const Quantity* quantity) {
  if (quantity == nullptr) return "-";
  const Display show = display_of(quantity->unit);
  return number(quantity->value * show.factor, show.digits);
}

/// Assumptions of each estimator: where they do not hold it is off, and the answer is not.
constexpr auto kAssumptions = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"straight", "from straight pieces alone; both wheels are off by one factor, and no effects"},
    {"spin", "from turns on the spot alone; no effects"},
    {"linear", "least squares without a model of wheels; sideways motion is noise to it"},
    {"joint_closed_form", "all motion, each pair alike, no effects, clocks that agree"},
    {"joint", "all motion, each pair by its noise, with the effects that were found: the answer"},
});

std::string assumption_of(const std::string& method) {
  const auto* found = std::find_if(kAssumptions.begin(), kAssumptions.end(),
                                   [&](const auto& one) { return one.first == method; });
  return found == kAssumptions.end() ? "" : std::string(found->second);
}

/// Value, and in brackets its difference from the answer in units of the two deviations together.
std::string compared(const Quantity* quantity, const Quantity& answer) {
  if (quantity == nullptr) return "-";
  std::string value = quantity_cell(quantity);
  if (quantity->std < 0.0 || answer.std < 0.0) return value;
  const double sigma = std::hypot(quantity->std, answer.std);
  return sigma > 0.0 ? fmt::format("{} ({:+.1f})", value, (quantity->value - answer.value) / sigma) : value;
}

Section methods_of(const Calibration& calibration) {
  Section section{"Estimators compared (difference from the answer in sigmas in brackets)", {}, {{""}, {}}};
  for (const auto& method : calibration.methods) {
    const std::string assumed = assumption_of(method.name);
    section.lines.push_back(readable(method.name) + (assumed.empty() ? "" : ": " + assumed) +
                            (method.refused ? "; refused: " + *method.refused : ""));
    if (!method.refused) section.table.head.push_back(readable(method.name));
  }
  if (!section.lines.empty())
    section.lines.emplace_back(
        "Many sigmas say that what an estimator takes for granted does not hold here, not that the answer is "
        "wrong.");
  for (const auto& [name, last] : calibration.parameters) {
    std::vector<std::string> row{readable(name) + " [" + display_of(last.unit).unit + "]"};
    for (const auto& method : calibration.methods) {
      if (method.refused) continue;
      const Quantity* quantity = find(method.parameters, name);
      row.push_back(compared(quantity, last));
    }
    section.table.rows.push_back(row);
  }
  std::vector<std::string> used{"pairs used"};
  for (const auto& method : calibration.methods)
    if (!method.refused) used.push_back(fmt::format("{} of {}", method.used, method.used + method.discarded));
  if (used.size() > 1) section.table.rows.push_back(used);
  if (section.table.head.size() < 2) section.table = {};
  return section;
}

/// The matrix that takes an increment of odometry to the sensor's, both in the frame of the base.
Section linear_of(const std::optional<LinearCorrection>& linear) {
  if (!linear) return {"", {}, {}};
  Section section{"Linear correction of an increment of odometry", {}, {{"", "x", "y", "yaw"}, {}}};
  const Display length = display_of("m"), angle = display_of("rad");
  section.lines = {
      fmt::format("leaves {:.2f} {}, {:.2f} {}, {:.3f} {} (RMS); condition of its normal matrix {:.0f}",
                  linear->rms[0] * length.factor, length.unit, linear->rms[1] * length.factor, length.unit,
                  linear->rms[2] * angle.factor, angle.unit, linear->condition),
      "wheels hardly move sideways: the column of y is badly determined, and no length comes from it"};
  const std::array<const char*, 3> names{"x", "y", "yaw"};
  for (std::size_t i = 0; i < 3; ++i) {
    std::vector<std::string> row{names.at(i)};
    for (const double element : linear->matrix.at(i)) row.push_back(fmt::format("{:.5f}", element));
    section.table.rows.push_back(row);
  }
  return section;
}

/// Effects that belong to the place or the day, or begin at another phase each time.
std::set<std::string> not_in_odometry(const Calibration& calibration) {
  std::set<std::string> names;
  for (const auto& placement : calib::odometry::effect_placements(calibration))
    if (placement.place == calib::odometry::Place::nowhere) names.insert(readable(placement.effect));
  return names;
}

std::vector<std::string> residual_row(const char* name, const std::optional<std::array<double, 3>>& rms) {
  if (!rms) return {name, "-", "-", "-"};
  return {name, number(1000.0 * (*rms)[0], 2), number(1000.0 * (*rms)[1], 2),
          number((*rms)[2] * 180.0 / std::numbers::pi, 3)};
}

Section residual_of(const Calibration& calibration) {
  const ResidualReport& residual = calibration.residual;
  const bool effects = !calibration.effects.empty();
  Section section{fmt::format("Residual of single motions{}{} (RMS)",
                              residual.held_out ? ", on data not used in the fit" : "",
                              effects ? ": without effects, with them" : ""),
                  {},
                  {}};
  if (!residual.before && !residual.after) return section;
  section.table.head = {"", "x mm", "y mm", "yaw deg"};
  if (effects) section.table.rows.push_back(residual_row("without effects", residual.before));
  section.table.rows.push_back(residual_row(effects ? "with effects" : "residual", residual.after));
  section.table.rows.push_back(residual_row("noise floor", residual.noise_floor));
  return section;
}

/// The robot, what it was calibrated from, and by what.
Section subject_section(const Calibration& calibration) {
  Section section{"Robot and recording", {}, {}};
  const auto add = [&section](const char* what, const std::string& text) {
    if (!text.empty()) section.table.rows.push_back({what, text});
  };
  add("robot", calibration.robot.robot_id);
  add("controller", calibration.robot.controller);
  add("place", settings_of(calibration).place);
  if (const auto& driven = calibration.driven) add("driven", utc_span(driven->begin, driven->end));
  for (const auto& data : calibration.data)
    add("recording", fmt::format("{}, {:.0f} s", data.name, data.duration));
  if (const std::string version = settings_of(calibration).version; !version.empty())
    add("solved by", "odomcalib " + version);
  add("note", settings_of(calibration).note);
  return section;
}

Section data_of(const Calibration& calibration) {
  Section section{"Data", {}, {}};
  for (const auto& data : calibration.data) {
    std::string line = fmt::format("{}: {:.1f} s", data.name, data.duration);
    for (const auto& [what, count] : data.counts) {
      if (count == 0) continue;
      line += fmt::format(", {} {}", count, what);
      if (data.duration > 0.0) line += fmt::format(" ({:.1f}/s)", static_cast<double>(count) / data.duration);
    }
    section.lines.push_back(line);
    for (const auto& choice : data.choices) section.lines.push_back("  " + choice);
    // Files of before say less of it.
    if (calibration.discarded.empty())
      for (const auto& [why, count] : data.discarded)
        section.lines.push_back(fmt::format("  not used: {} {}", count, why));
    section.lines.push_back("  SHA-256 " + data.sha256);
  }
  for (const std::string& line : evidence_lines(calibration)) section.lines.push_back(line);
  return section;
}

}  // namespace

std::string headline(Verdict verdict) {
  if (verdict == Verdict::accepted) return "ACCEPTED";
  return verdict == Verdict::refused ? "REFUSED" : "ACCEPTED WITH WARNINGS";
}

/// Recordings of the service need no choices: a choice was made in somebody else's recording.
bool is_from_elsewhere(const Calibration& calibration) {
  return std::any_of(calibration.data.begin(), calibration.data.end(),
                     [](const DataUse& data) { return !data.choices.empty(); });
}

bool runs_ros2(const Calibration& calibration) {
  return std::any_of(calibration.data.begin(), calibration.data.end(),
                     [](const DataUse& data) { return data.middleware == Middleware::ros2; });
}

std::string next_step(const Calibration& calibration) {
  if (calibration.verdict == Verdict::accepted && calibration.next_step.empty())
    return is_from_elsewhere(calibration)
               ? "Next: odomcalibctl export --what diff_drive prints these values for ros2_control, --what "
                 "toml for other programs."
               : "Next: odomcalibctl apply writes these values to the controller.";
  // Files of earlier versions state none.
  const std::string step = calibration.next_step.empty() ? "do what the first reason says, and solve again"
                                                         : calibration.next_step;
  return "Next: " + step + (calibration.verdict == Verdict::refused ? ". Nothing was written." : ".");
}

Document::Tone tone_of(Verdict verdict) {
  if (verdict == Verdict::accepted) return Document::Tone::good;
  return verdict == Verdict::refused ? Document::Tone::bad : Document::Tone::doubtful;
}

std::string metre_of(const Calibration& calibration) {
  const auto& scale = calibration.scale;
  if (!scale) return "";
  return scale->source == "lidar data sheet" ? "lidar" : "tape";
}

SolveSettings settings_of(const Calibration& calibration) {
  return calibration.settings.value_or(SolveSettings{});
}

Section parameters_section(const Calibration& calibration) {
  const auto& scale = calibration.scale;
  Section section{"Parameters", {}, {{"", "nominal", "value", "repeatable to", "unit", "change"}, {}}};
  if (scale)
    section.table.head.insert(section.table.head.begin() + 4, "true to (" + metre_of(calibration) + ")");
  for (const auto& [name, quantity] : calibration.parameters)
    section.table.rows.push_back(parameter_row(calibration.robot, name, quantity, scale));
  if (scale)
    section.lines.push_back(fmt::format(
        "Repeatable to: two deviations against the metre of the reference. True to: with that metre, "
        "which is known to +-{:.3g} % ({}); --scale states what a tape says.",
        100.0 * 2.0 * scale->std / scale->value, scale->source));
  return section;
}

Section effects_section(const Calibration& calibration) {
  Section section{
      "Effects", effect_lines(calibration), {{"", "value", "repeatable to", "unit", "p", "stored in"}, {}}};
  for (const auto& effect : calibration.effects)
    for (const auto& [name, quantity] : effect.parameters) {
      const Display show = display_of(effect.name, name, quantity);
      section.table.rows.push_back({label_of(effect.name, name),
                                    number(quantity.value * show.factor, show.digits),
                                    twice(quantity.std, show), show.unit,
                                    fmt::format("{:.2g}", effect.evidence.p_value), effect.stored_in});
    }
  if (section.table.rows.empty()) section.table = {};
  if (const auto& rest = calibration.unexplained) {
    std::string on;
    for (const auto& variable : rest->depends_on) on += (on.empty() ? "" : ", ") + readable(variable);
    section.lines.push_back(
        fmt::format("unexplained: the residual depends on {} (p {:.2g})", on, rest->p_value));
  }
  for (const std::string& name : not_in_odometry(calibration))
    section.lines.push_back(
        name +
        ": of this place, day or drive; odometry goes on without it, and \"after\" is what "
        "knowing it here and now would make of the errors");
  for (const auto& effect : calibration.effects) {
    std::string others;
    for (const auto& alias : effect.aliases) others += (others.empty() ? "" : ", ") + readable(alias);
    if (!others.empty())
      section.lines.push_back(readable(effect.name) + " cannot be separated from " + others +
                              " with this drive");
  }
  return section;
}

Section gain_section(const Calibration& calibration) {
  const std::string gain = gain_sentence(calibration, report_data_of(calibration));
  return {"", gain.empty() ? std::vector<std::string>{} : std::vector{gain}, {}};
}

Section verdict_section(const Calibration& calibration) {
  Section section{"", calibration.reasons, {}};
  if (const std::string lost = lost_without_effects(calibration, false);
      calibration.verdict != Verdict::refused && runs_ros2(calibration) && !lost.empty())
    section.lines.push_back("controllers of ROS 2 hold lengths alone; " + lost);
  section.lines.push_back(next_step(calibration));
  return section;
}

Document describe(const Calibration& calibration, const std::vector<Section>& written) {
  const ReportData data = report_data_of(calibration);
  Document document{
      headline(calibration.verdict), {verdict_section(calibration)}, tone_of(calibration.verdict)};
  std::vector<Section> sections = {gain_section(calibration),
                                   parameters_section(calibration),
                                   drive_errors_section(calibration, data, true),
                                   effects_section(calibration),
                                   traces_section(data),
                                   not_found_section(data, false),
                                   meanings_section(calibration),
                                   path_section(data),
                                   residual_of(calibration),
                                   methods_of(calibration),
                                   linear_of(calibration.linear_correction),
                                   determination_section(calibration),
                                   repeatability_section(calibration, data),
                                   residual_shape_section(data),
                                   further_figures_section(labelled_figures(calibration)),
                                   data_of(calibration),
                                   settings_section(calibration)};
  sections.insert(sections.end() - 2, written.begin(), written.end());
  for (Section& section : sections)
    if (!section.lines.empty() || !section.table.rows.empty())
      document.sections.push_back(std::move(section));
  return document;
}

std::vector<std::pair<std::string, std::vector<Section>>> folded_sections(
    const Calibration& calibration, const std::vector<Section>& written) {
  const ReportData data = report_data_of(calibration);
  Section traces = traces_section(data);
  // The first figure stands on the first screen.
  if (!traces.figures.empty()) traces.figures.erase(traces.figures.begin());
  std::vector<std::pair<std::string, std::vector<Section>>> groups = {
      {"Errors before and after", {drive_errors_section(calibration, data, true), residual_of(calibration)}},
      {"What was found", {effects_section(calibration), meanings_section(calibration), traces}},
      {"How sure the values are",
       {repeatability_section(calibration, data), determination_section(calibration), methods_of(calibration),
        linear_of(calibration.linear_correction)}},
      {"What is left: the residual", {residual_shape_section(data)}},
      {kDriveTitle, {path_section(data)}},
      {"What was not found", {not_found_section(data, true)}},
      {written.empty() ? "" : written.front().title, written},
      {"Data and settings",
       {subject_section(calibration), further_figures_section(labelled_figures(calibration)),
        data_of(calibration), settings_section(calibration)}},
      {"How to read this page", {reading_section()}}};
  for (auto& [title, sections] : groups)
    std::erase_if(sections, [](const Section& one) { return one.lines.empty() && one.table.rows.empty(); });
  std::erase_if(groups, [](const auto& group) { return group.second.empty(); });
  return groups;
}

}  // namespace odomcalib::cli
