#include "daemon/cli/report_sections.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "calib/terms/catalogue.hpp"
#include "daemon/cli/display.hpp"
#include "daemon/cli/plain_words.hpp"
#include "daemon/cli/report_figures.hpp"
#include "daemon/cli/settings.hpp"

namespace odomcalib::cli {
namespace {

std::string title_of(const std::string& name) {
  if (name == "straight_metre_length") return "a metre straight: length";
  if (name == "straight_metre_heading") return "a metre straight: heading";
  if (name == "full_turn_heading") return "a full turn: heading";
  if (name == "open_loop_10s_position") return "10 s without reference: position";
  if (name == "open_loop_10s_heading") return "10 s without reference: heading";
  return readable(name);
}

std::string figure_text(const std::optional<Bounded>& figure, const Display& show, bool interval) {
  if (!figure) return "-";
  if (!interval) return number(figure->value * show.factor, 2);
  return fmt::format("{} ({}..{})", number(figure->value * show.factor, 2),
                     number(figure->low * show.factor, 2), number(figure->high * show.factor, 2));
}

std::vector<std::string> error_row(const DriveError& error, bool geometry, bool intervals) {
  const Display show = display_of(error.unit);
  intervals = intervals && error.stretches >= settings::kFewestForInterval;
  std::vector<std::string> row{title_of(error.name), show.unit, figure_text(error.before, show, intervals)};
  if (geometry) row.push_back(figure_text(error.geometry, show, intervals));
  row.push_back(figure_text(error.after, show, intervals));
  row.push_back(error.noise_floor ? number(*error.noise_floor * show.factor, 2) : "-");
  row.push_back(std::to_string(error.stretches));
  return row;
}

/// Systematic part of the residual: RMS over the means of sixteenths.
double systematic(const ResidualTrace& trace, double ResidualTrace::Bin::*member) {
  double sum = 0.0;
  for (const auto& bin : trace.bins) sum += bin.*member * bin.*member;
  return std::sqrt(sum / std::max(static_cast<double>(trace.bins.size()), 1.0));
}

/// A wave of what rolls unseen has no variable that could be drawn.
std::string dependence_of(const ResidualTrace& trace) {
  if (trace.explained < settings::kDependsOn)
    return fmt::format("no variable alone shows its pattern; the {} residual over {}", trace.residual,
                       trace.variable);
  return fmt::format("the {} residual depends on {}", trace.residual, trace.variable);
}

/// A term that is too small to be reported is no effect to be with or without.
bool has_more_than_dimensions(const Calibration& calibration) {
  return !calibration.effects.empty() || calibration.unexplained;
}

}  // namespace

Section drive_errors_section(const Calibration& calibration, const ReportData& data, bool intervals) {
  Section section{fmt::format("What odometry is off by, on data not used in the fit (RMS{})",
                              intervals ? ", 95 % interval from ten stretches on" : ""),
                  {},
                  {}};
  const bool geometry = has_more_than_dimensions(calibration) &&
                        std::any_of(data.drive_errors.begin(), data.drive_errors.end(),
                                    [](const DriveError& e) { return e.geometry.has_value(); });
  for (const DriveError& error : data.drive_errors)
    section.table.rows.push_back(error_row(error, geometry, intervals));
  if (section.table.rows.empty()) {
    // Too short to be fitted in parts and tested in the others; a refused one has said why.
    if (!calibration.residual.held_out && calibration.verdict != Verdict::refused)
      section.lines = {
          "Not stated: of a recording this short nothing can be left out of the fit. Record a minute or "
          "more."};
    return section;
  }
  section.table.head = {"", "", "before", "after", "noise floor", "stretches"};
  if (geometry) section.table.head.insert(section.table.head.begin() + 3, "without effects");
  return section;
}

Section traces_section(const ReportData& data) {
  Section section{"What was found, and what is left of it", {}, {}};
  for (const ResidualTrace& trace : data.traces) {
    const Display show = display_of(trace.residual_unit);
    section.lines.push_back(fmt::format(
        "{}: {}; RMS of its means {} {} without it, {} {} with it", readable(trace.effect),
        dependence_of(trace), number(systematic(trace, &ResidualTrace::Bin::before) * show.factor, 2),
        show.unit, number(systematic(trace, &ResidualTrace::Bin::after) * show.factor, 2), show.unit));
    section.figures.push_back(figure_of_trace(trace));
  }
  return section;
}

Section not_found_section(const ReportData& data, bool meanings) {
  Section section{"What was not found, and the size at which nine of ten such drives would show it", {}, {}};
  for (const Detectable& effect : data.detectable) {
    const Display show = display_of(effect.effect, effect.parameter, {0.0, -1.0, effect.unit});
    const auto size = [&show](double value) {
      return significant(value * show.factor) + (show.unit.empty() ? "" : " " + show.unit);
    };
    const bool shows = effect.smallest && *effect.smallest < settings::kNever * effect.typical;
    std::vector<std::string> row{label_of(effect.effect, effect.parameter),
                                 shows ? size(*effect.smallest) : "never", size(effect.typical)};
    const auto* meaning = calib::terms::meaning_of(effect.effect, effect.parameter);
    if (meanings) row.insert(row.begin() + 1, meaning == nullptr ? "" : std::string(meaning->is));
    section.table.rows.push_back(std::move(row));
    const std::string line = "No test of " + readable(effect.effect) + ", which takes " + effect.motion;
    const bool tests = effect.smallest && *effect.smallest < effect.typical;
    if (!tests && (section.lines.empty() || section.lines.back() != line)) section.lines.push_back(line);
  }
  if (section.table.rows.empty()) return section;
  section.table.head = {"", "shows from", "typical"};
  if (meanings) section.table.head.insert(section.table.head.begin() + 1, "what it is");
  return section;
}

Section meanings_section(const Calibration& calibration) {
  Section section{"What the parameters of these effects are", {}, {}};
  for (const EffectResult& effect : calibration.effects)
    for (const auto& [parameter, quantity] : effect.parameters)
      if (const auto* meaning = calib::terms::meaning_of(effect.name, parameter))
        section.table.rows.push_back({label_of(effect.name, parameter), std::string(meaning->is)});
  return section;
}

Section path_section(const ReportData& data) {
  Section section{kDriveTitle, {}, {}};
  for (const PathTrace& path : data.paths) {
    if (path.points.empty()) continue;
    const auto& end = path.points.back();
    section.lines.push_back(fmt::format("{}: ends at x {:.3f} m, y {:.3f} m", path.name, end[0], end[1]));
  }
  if (!data.scans.empty()) {
    section.lines.push_back(
        fmt::format("{} scans of 20 s are laid on each other, of the block with the most motion; the values "
                    "that place them "
                    "are fitted to the other blocks",
                    data.scans.size()));
    section.figures.push_back(figure_of_scans(data.scans));
  }
  if (!data.paths.empty()) section.figures.push_back(figure_of_paths(data.paths));
  return section;
}

Section determination_section(const Calibration& calibration) {
  Section section{"How well the motion determined the parameters: correlations", {}, {}};
  const auto& matrix = calibration.covariance;
  std::vector<std::size_t> free;
  for (std::size_t k = 0; k < matrix.size() && k < calibration.covariance_order.size(); ++k)
    if (matrix[k].size() == matrix.size() && matrix[k][k] > 0.0) free.push_back(k);
  if (free.size() < 2) return section;
  const auto n = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd correlation(n, n);
  section.table.head = {""};
  for (const std::size_t k : free) section.table.head.push_back(readable(calibration.covariance_order[k]));
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t a = free[static_cast<std::size_t>(i)];
    std::vector<std::string> row{readable(calibration.covariance_order[a])};
    for (Eigen::Index j = 0; j < n; ++j) {
      const std::size_t b = free[static_cast<std::size_t>(j)];
      correlation(i, j) = matrix[a][b] / std::sqrt(matrix[a][a] * matrix[b][b]);
      row.push_back(j <= i ? number(correlation(i, j), 2) : "");
    }
    section.table.rows.push_back(row);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(correlation, Eigen::EigenvaluesOnly);
  const double smallest = eigen.eigenvalues()(0);
  section.lines.push_back(
      smallest > 0.0
          ? fmt::format("condition of the correlations {:.1f}; beyond 1000 the motion hardly separates "
                        "two parameters apart",
                        eigen.eigenvalues()(n - 1) / smallest)
          : "the correlations are singular: the motion does not separate the parameters");
  return section;
}

Section repeatability_section(const Calibration& calibration, const ReportData& data) {
  Section section{"Fitted without one fifth of the data, five times", {}, {}};
  for (const auto& [name, values] : data.left_out) {
    const auto found = std::find_if(calibration.parameters.begin(), calibration.parameters.end(),
                                    [&n = name](const auto& p) { return p.first == n; });
    if (found == calibration.parameters.end() || values.empty() || found->second.std < 0.0) continue;
    const Display show = display_of(found->second.unit);
    std::vector<std::string> row{readable(name), show.unit};
    for (const double value : values) row.push_back(number((value - found->second.value) * show.factor, 3));
    row.push_back(number(2.0 * found->second.std * show.factor, 3));
    section.table.rows.push_back(row);
  }
  if (!section.table.rows.empty())
    section.table.head = {"difference from the answer", "", "1", "2", "3", "4", "5", "repeatable to"};
  return section;
}

Section residual_shape_section(const ReportData& data) {
  Section section{"Residual of the final model, in the frame of the sensor", {}, {}};
  for (const ResidualAxis& axis : data.axes) {
    const Display show = display_of(axis.unit);
    section.table.rows.push_back(
        {axis.name, show.unit, number(axis.mean * show.factor, 3), number(axis.std * show.factor, 3),
         number(axis.normalised, 2), number(axis.autocorrelation, 2), number(axis.runs, 1),
         significant(axis.reference_std * show.factor), significant(axis.wheels_std * show.factor)});
  }
  if (section.table.rows.empty()) return section;
  section.table.head = {
      "", "", "mean", "std", "std / expected", "autocorrelation", "runs test", "reference std", "wheels std"};
  section.figures = figures_of_residual(data);
  return section;
}

Section further_figures_section(const std::vector<LabelledFigure>& figures) {
  Section section{"Further figures", {}, {}};
  for (const LabelledFigure& figure : figures) {
    const Display show = display_of(figure.unit);
    section.table.rows.push_back({figure.label, significant(figure.value * show.factor), show.unit});
  }
  if (!section.table.rows.empty()) section.table.head = {"", "value", "unit"};
  return section;
}

Section settings_section(const Calibration& calibration) {
  Section section{"Settings and notes", {}, {}};
  if (!calibration.settings) return section;
  const auto add = [&section](const std::string& name, const nlohmann::ordered_json& value) {
    section.lines.push_back(readable(name) + ": " +
                            (value.is_string() ? value.get<std::string>() : value.dump()));
  };
  const nlohmann::ordered_json settings = to_json(*calibration.settings);
  for (const auto& [name, value] : settings.items()) add(name, value);
  if (const auto newer = calibration.unknown.find("settings"); newer != calibration.unknown.end())
    for (const auto& [name, text] : newer->second)
      add(name, nlohmann::ordered_json::parse(text, nullptr, false));
  return section;
}

Section reading_section() {
  constexpr const char* kBefore =
      "Before: odometry with the nominal values. After: with the values of this file and its effects. "
      "Both are judged on parts of the recording that their values were not fitted to.";
  constexpr const char* kFloor =
      "Noise floor: what the error would be if the model were perfect and only the noise of the "
      "reference and of the wheels remained. After cannot be much below it; well above it, something is "
      "still missing.";
  constexpr const char* kResidual =
      "std / expected near 1 and a runs test within -2 to 2: the residual is noise. Larger: something "
      "is missing or the matches are worse than they say.";
  constexpr const char* kDeviations =
      "Repeatable to: two standard deviations of the value in another such drive, against the same metre. "
      "True "
      "to: with the error of that metre, which all lengths share; no ratio of two lengths depends on it.";
  constexpr const char* kProbability =
      "p of an effect: how probable so strong a trace of it is on a robot that does not have it.";
  return {"How to read this page",
          {kDeviations, kBefore, kFloor, kResidual, kProbability, "More: odomcalib-report(7)."},
          {}};
}

}  // namespace odomcalib::cli
