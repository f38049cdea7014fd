#include "daemon/cli/export_formats.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <optional>

#include "daemon/cli/usable_calibration.hpp"
#include "proto/calibration/report_data.hpp"

namespace odomcalib::cli {
namespace {

/// RFC 4180: a field with a comma, a quote or a line break is quoted, quotes are doubled.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

/// Empty for what is not known; otherwise the shortest text that reads back to the same number.
std::string field(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }
std::string field(const std::optional<double>& value) { return value ? field(*value) : ""; }
std::string deviation(double std) { return std >= 0.0 ? field(std) : ""; }

template <typename... Fields>
void line(std::string& out, const Fields&... fields) {
  std::string row;
  ((row += (row.empty() ? "" : ",") + std::string(fields)), ...);
  out += row + "\n";
}

std::string parameters_csv(const Calibration& calibration) {
  std::string out = "name,value,std,unit\n";
  for (const auto& [name, q] : calibration.parameters)
    line(out, field(name), field(q.value), deviation(q.std), field(q.unit));
  return out;
}

std::string effects_csv(const Calibration& calibration) {
  std::string out = "effect,parameter,value,std,unit,p_value,stored_in\n";
  for (const auto& effect : calibration.effects)
    for (const auto& [name, q] : effect.parameters)
      line(out, field(effect.name), field(name), field(q.value), deviation(q.std), field(q.unit),
           field(effect.evidence.p_value), field(effect.stored_in));
  return out;
}

std::string bounded(const std::optional<Bounded>& figure) {
  return figure ? field(figure->value) + "," + field(figure->low) + "," + field(figure->high) : ",,";
}

std::string errors_csv(const ReportData& data) {
  std::string out =
      "name,unit,before,before_low,before_high,geometry,geometry_low,geometry_high,after,after_low,after_"
      "high,"
      "noise_floor,stretches\n";
  for (const auto& e : data.drive_errors)
    line(out, field(e.name), field(e.unit), bounded(e.before), bounded(e.geometry), bounded(e.after),
         field(e.noise_floor), std::to_string(e.stretches));
  return out;
}

std::string residual_csv(const ReportData& data) {
  std::string out = "t,x_sigmas,y_sigmas,yaw_sigmas\n";
  for (const auto& s : data.series)
    line(out, field(s.t), field(s.sigmas[0]), field(s.sigmas[1]), field(s.sigmas[2]));
  return out;
}

std::string paths_csv(const ReportData& data) {
  std::string out = "path,x,y,yaw\n";
  for (const auto& path : data.paths)
    for (const auto& [x, y, yaw] : path.points) line(out, field(path.name), field(x), field(y), field(yaw));
  return out;
}

std::string traces_csv(const ReportData& data) {
  std::string out = "effect,variable,variable_unit,residual,residual_unit,value,before,after\n";
  for (const auto& t : data.traces)
    for (const auto& p : t.points)
      line(out, field(t.effect), field(t.variable), field(t.variable_unit), field(t.residual),
           field(t.residual_unit), field(p.variable), field(p.before), field(p.after));
  return out;
}

/// As `--robot` reads it.
std::string robot_toml(const Calibration& calibration, const Dimensions& d) {
  std::string out = fmt::format("left_wheel_diameter = {}\nright_wheel_diameter = {}\ntrack_width = {}\n",
                                d.left, d.right, d.track);
  if (calibration.robot.ticks_per_rev > 0.0)
    fmt::format_to(std::back_inserter(out), "ticks_per_rev = {:.1f}\n", calibration.robot.ticks_per_rev);
  const auto x = calibration.parameter("lidar_x");
  const auto y = calibration.parameter("lidar_y");
  const auto yaw = calibration.parameter("lidar_yaw");
  if (x && y && yaw) fmt::format_to(std::back_inserter(out), "lidar_pose = [{}, {}, {}]\n", *x, *y, *yaw);
  return out;
}

/// One radius and a factor for each wheel; effects that only a host can compensate are not in these
/// parameters.
std::string diff_drive_yaml(const Dimensions& d) {
  return fmt::format(
      "diff_drive_controller:\n  ros__parameters:\n    wheel_separation: {}\n    wheel_radius: {}\n"
      "    wheel_separation_multiplier: 1.0\n    left_wheel_radius_multiplier: {}\n"
      "    right_wheel_radius_multiplier: {}\n",
      d.track, 0.5 * d.mean(), d.left / d.mean(), d.right / d.mean());
}

}  // namespace

const std::vector<std::string>& export_formats() {
  static const std::vector<std::string> formats = {"parameters", "effects", "errors", "residual",
                                                   "paths",      "traces",  "toml",   "diff_drive"};
  return formats;
}

std::string pairs_csv(const std::vector<calib::measurement::SamplePair>& pairs,
                      const std::vector<std::string>& recordings) {
  std::string out =
      "recording,begin,end,odometry_x,odometry_y,odometry_yaw,reference_x,reference_y,reference_yaw\n";
  for (const auto& p : pairs)
    line(out, field(recordings.at(p.recording)), field(p.begin), field(p.end), field(p.odometry[0]),
         field(p.odometry[1]), field(p.odometry[2]), field(p.reference[0]), field(p.reference[1]),
         field(p.reference[2]));
  return out;
}

bool is_configuration(const std::string& what) { return what == "toml" || what == "diff_drive"; }

Result<std::string> exported(const Calibration& calibration, const std::string& what,
                             const std::string& where) {
  if (what == "parameters") return parameters_csv(calibration);
  if (what == "effects") return effects_csv(calibration);
  const ReportData data = report_data_of(calibration);
  if (what == "errors") return errors_csv(data);
  if (what == "residual") return residual_csv(data);
  if (what == "paths") return paths_csv(data);
  if (what == "traces") return traces_csv(data);
  // A robot would be driven by these.
  if (calibration.verdict == Verdict::refused) return refusal_of(calibration, where);
  const auto dimensions = dimensions_of(calibration, where);
  if (!dimensions) return dimensions.error();
  if (what == "toml") return robot_toml(calibration, dimensions.value());
  if (what == "diff_drive") return diff_drive_yaml(dimensions.value());
  return Error{ErrorCode::usage, "unknown export \"" + what + "\"", "--what",
               "see odomcalibctl export --help"};
}

}  // namespace odomcalib::cli
