#include "daemon/cli/export_formats.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "daemon/cli/export_configurations.hpp"
#include "proto/calibration/report_data.hpp"
#include "proto/calibration/scale.hpp"

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
  std::string out = "name,value,std,unit,std_absolute\n";
  const auto& scale = calibration.scale;
  for (const auto& [name, q] : calibration.parameters)
    line(out, field(name), field(q.value), deviation(q.std), field(q.unit),
         scale ? deviation(absolute_deviation(q, *scale)) : "");
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

}  // namespace

const std::vector<std::string>& export_formats() {
  static const std::vector<std::string> formats = [] {
    std::vector<std::string> all = {"parameters", "effects", "errors", "residual", "paths", "traces"};
    all.insert(all.end(), configurations().begin(), configurations().end());
    return all;
  }();
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

Result<std::string> exported(const Calibration& calibration, const std::string& what,
                             const std::string& where) {
  if (what == "parameters") return parameters_csv(calibration);
  if (what == "effects") return effects_csv(calibration);
  const ReportData data = report_data_of(calibration);
  if (what == "errors") return errors_csv(data);
  if (what == "residual") return residual_csv(data);
  if (what == "paths") return paths_csv(data);
  if (what == "traces") return traces_csv(data);
  if (is_configuration(what)) return configuration(calibration, what, where);
  return Error{ErrorCode::usage, "unknown export \"" + what + "\"", "--what",
               "see odomcalibctl export --help"};
}

}  // namespace odomcalib::cli
