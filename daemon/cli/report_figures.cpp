#include "daemon/cli/report_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "daemon/cli/display.hpp"

namespace odomcalib::cli {
namespace {

using Style = Curve::Style;
using Tone = Curve::Tone;

Tone tone_of_path(const std::string& name) {
  if (name == "odometry") return Tone::before;
  return name == "reference" ? Tone::reference : Tone::after;
}

std::string label_of_path(const std::string& name) {
  if (name == "odometry") return "odometry, nominal values";
  return name == "reference" ? "lidar or other reference" : "odometry, calibrated";
}

std::string labelled(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " [" + unit + "]";
}

Curve histogram(const ResidualAxis& axis, Tone tone) {
  Curve curve{axis.name, Style::steps, tone, {}};
  double total = 0.0;
  for (const std::size_t count : axis.histogram) total += static_cast<double>(count);
  const double width = axis.histogram.empty() ? 1.0 : 10.0 / static_cast<double>(axis.histogram.size());
  for (std::size_t k = 0; k < axis.histogram.size(); ++k)
    curve.points.push_back({-5.0 + width * static_cast<double>(k),
                            100.0 * static_cast<double>(axis.histogram[k]) / std::max(total, 1.0)});
  if (!curve.points.empty()) curve.points.push_back({5.0, 0.0});
  return curve;
}

}  // namespace

Figure figure_of_paths(const std::vector<PathTrace>& paths) {
  Figure figure{
      "Where the robot was, by odometry before and after, and by the reference, whose single motions are "
      "chained here and drift too. Start at 0, 0.",
      "x [m]",
      "y [m]",
      true,
      {}};
  for (const PathTrace& path : paths) {
    Curve curve{label_of_path(path.name), Style::line, tone_of_path(path.name), {}};
    for (const auto& [x, y, yaw] : path.points) curve.points.push_back({x, y});
    figure.curves.push_back(std::move(curve));
  }
  // Broad and below the others: what agrees with it would hide it, or be hidden.
  std::stable_partition(figure.curves.begin(), figure.curves.end(),
                        [](const Curve& curve) { return curve.tone == Tone::reference; });
  return figure;
}

Figure figure_of_scans(const std::vector<ScanTrace>& scans) {
  Figure figure{
      "Scans laid on each other by odometry alone, on a stretch that the values were not fitted to: the "
      "better odometry is, the thinner are the walls.",
      "x [m]",
      "y [m]",
      true,
      {}};
  const auto add = [&](const std::string& name, std::array<double, 3> ScanTrace::*of) {
    Curve curve{label_of_path(name), Style::dots, tone_of_path(name), {}};
    for (const ScanTrace& scan : scans) {
      const auto& [x, y, yaw] = scan.*of;
      const double c = std::cos(yaw), s = std::sin(yaw);
      for (const auto& [ahead, left] : scan.points)
        curve.points.push_back({x + c * ahead - s * left, y + s * ahead + c * left});
    }
    figure.curves.push_back(std::move(curve));
  };
  add("odometry", &ScanTrace::before);
  add("calibrated", &ScanTrace::after);
  return figure;
}

Figure figure_of_growth(const std::vector<ErrorGrowth>& growth, bool has_effects) {
  Figure figure{
      "Error of the position against the distance driven, on parts of the recording that the values were not "
      "fitted to (RMS).",
      "distance driven [m]",
      "error of the position [mm]",
      false,
      {}};
  const auto add = [&](const char* label, Tone tone, std::optional<double> ErrorGrowth::*of) {
    Curve curve{label, Style::line, tone, {{0.0, 0.0}}};
    for (const ErrorGrowth& one : growth)
      if (one.*of) curve.points.push_back({one.way, 1000.0 * *(one.*of)});
    if (curve.points.size() > 2) figure.curves.push_back(std::move(curve));
  };
  add("before", Tone::before, &ErrorGrowth::before);
  if (has_effects) add("without effects", Tone::reference, &ErrorGrowth::geometry);
  add("now", Tone::after, &ErrorGrowth::after);
  return figure;
}

Figure figure_of_trace(const ResidualTrace& trace) {
  const Display show = display_of(trace.residual_unit);
  Figure figure{
      fmt::format("{}: residual against {}. Dots: single measurements (thinned); lines: means of sixteenths "
                  "with 95 % intervals.",
                  readable(trace.effect), trace.variable),
      labelled(trace.variable, trace.variable_unit),
      labelled(trace.residual + " residual", show.unit),
      false,
      {}};
  Curve before{"", Style::dots, Tone::before, {}};
  Curve after{"", Style::dots, Tone::after, {}};
  for (const auto& p : trace.points) {
    before.points.push_back({p.variable, p.before * show.factor});
    after.points.push_back({p.variable, p.after * show.factor});
  }
  Curve mean_before{"without the effect", Style::line, Tone::before, {}};
  Curve mean_after{"with it", Style::line, Tone::after, {}};
  for (const auto& b : trace.bins) {
    mean_before.points.push_back({b.variable, b.before * show.factor});
    mean_before.errors.push_back(b.before_error * show.factor);
    mean_after.points.push_back({b.variable, b.after * show.factor});
    mean_after.errors.push_back(b.after_error * show.factor);
  }
  figure.curves = {before, after, mean_before, mean_after};
  return figure;
}

std::vector<Figure> figures_of_residual(const ReportData& data) {
  constexpr std::array kTones = {Tone::after, Tone::before, Tone::reference};
  Figure time{
      "Residual over time in units of its expected standard deviation. Two thirds within 1, no waves: the "
      "model is complete.",
      "time [s]",
      "sigmas",
      false,
      {}};
  Figure counts{
      "How the residual is distributed. The bell of a complete model has 38 % within half a sigma of zero.",
      "sigmas",
      "share [%]",
      false,
      {}};
  for (std::size_t axis = 0; axis < std::min(kTones.size(), data.axes.size()); ++axis) {
    Curve curve{data.axes[axis].name, Style::dots, kTones.at(axis), {}};
    for (const auto& sample : data.series) curve.points.push_back({sample.t, sample.sigmas.at(axis)});
    time.curves.push_back(std::move(curve));
    counts.curves.push_back(histogram(data.axes[axis], kTones.at(axis)));
  }
  return {time, counts};
}

}  // namespace odomcalib::cli
