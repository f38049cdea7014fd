#include "proto/calibration/report_data.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace odomcalib {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kErrorsMember = "drive_errors";
constexpr const char* kDetectableMember = "detectable";

/// Six significant digits: more than a picture shows, and the file stays small.
Json rounded_number(double value) {
  if (!std::isfinite(value)) return nullptr;
  if (value == 0.0) return 0.0;
  const double scale = std::pow(10.0, 5.0 - std::floor(std::log10(std::abs(value))));
  return std::isfinite(scale) ? Json(std::round(value * scale) / scale) : Json(value);
}

Json bounded(const std::optional<Bounded>& figure) {
  if (!figure) return nullptr;
  return {{"value", rounded_number(figure->value)},
          {"interval", {rounded_number(figure->low), rounded_number(figure->high)}}};
}

Json to_json(const DriveError& error) {
  return {{"name", error.name},
          {"unit", error.unit},
          {"stretches", error.stretches},
          {"before", bounded(error.before)},
          {"geometry", bounded(error.geometry)},
          {"after", bounded(error.after)},
          {"noise_floor", error.noise_floor ? rounded_number(*error.noise_floor) : Json(nullptr)}};
}

template <typename... Numbers>
Json row(Numbers... values) {
  Json out = Json::array();
  (out.push_back(rounded_number(values)), ...);
  return out;
}

Json to_json(const ErrorGrowth& growth) {
  const double nan = std::nan("");
  return row(growth.way, static_cast<double>(growth.stretches), growth.before.value_or(nan),
             growth.geometry.value_or(nan), growth.after.value_or(nan));
}

Json to_json(const ResidualTrace& trace) {
  Json out{{"effect", trace.effect},
           {"variable", trace.variable},
           {"variable_unit", trace.variable_unit},
           {"residual", trace.residual},
           {"residual_unit", trace.residual_unit},
           {"explained", rounded_number(trace.explained)},
           {"points", Json::array()},
           {"bins", Json::array()}};
  for (const auto& p : trace.points) out["points"].push_back(row(p.variable, p.before, p.after));
  for (const auto& b : trace.bins)
    out["bins"].push_back(row(b.variable, b.before, b.before_error, b.after, b.after_error));
  return out;
}

Json to_json(const Detectable& effect) {
  return {{"effect", effect.effect},
          {"parameter", effect.parameter},
          {"unit", effect.unit},
          {"smallest", effect.smallest ? rounded_number(*effect.smallest) : Json(nullptr)},
          {"typical", rounded_number(effect.typical)},
          {"motion", effect.motion}};
}

Json to_json(const PathTrace& path) {
  Json points = Json::array();
  for (const auto& [x, y, yaw] : path.points) points.push_back(row(x, y, yaw));
  return {{"name", path.name}, {"points", points}};
}

/// Whole millimetres.
Json to_json(const ScanTrace& scan) {
  constexpr double kParts = 1000.0;
  Json points = Json::array();
  for (const auto& [x, y] : scan.points)
    points.push_back(row(std::round(x * kParts) / kParts, std::round(y * kParts) / kParts));
  return {{"before", row(scan.before[0], scan.before[1], scan.before[2])},
          {"after", row(scan.after[0], scan.after[1], scan.after[2])},
          {"points", points}};
}

Json to_json(const ResidualAxis& axis) {
  return {{"name", axis.name},
          {"unit", axis.unit},
          {"mean", rounded_number(axis.mean)},
          {"std", rounded_number(axis.std)},
          {"normalised", rounded_number(axis.normalised)},
          {"autocorrelation", rounded_number(axis.autocorrelation)},
          {"runs", rounded_number(axis.runs)},
          {"histogram", axis.histogram},
          {"reference_std", rounded_number(axis.reference_std)},
          {"wheels_std", rounded_number(axis.wheels_std)}};
}

Json to_json(const ResidualSample& sample) {
  return row(sample.t, sample.sigmas[0], sample.sigmas[1], sample.sigmas[2]);
}

template <typename T>
Json list(const std::vector<T>& items) {
  Json out = Json::array();
  for (const T& item : items) out.push_back(to_json(item));
  return out;
}

// Reading: nlohmann's exceptions on wrong types end in report_data_of.

double number_of(const Json& value) { return value.is_null() ? std::nan("") : value.get<double>(); }

std::vector<double> numbers_of(const Json& values, std::size_t least) {
  std::vector<double> out;
  for (const auto& value : values) out.push_back(number_of(value));
  out.resize(std::max(out.size(), least), std::nan(""));
  return out;
}

std::optional<Bounded> bounded_of(const Json& value) {
  if (value.is_null()) return std::nullopt;
  const auto interval = numbers_of(value.at("interval"), 2);
  return Bounded{number_of(value.at("value")), interval[0], interval[1]};
}

DriveError error_of(const Json& value) {
  DriveError error{value.at("name"), value.at("unit"), value.at("stretches"), {}, {}, {}, {}};
  error.before = bounded_of(value.at("before"));
  error.geometry = bounded_of(value.at("geometry"));
  error.after = bounded_of(value.at("after"));
  if (!value.at("noise_floor").is_null()) error.noise_floor = number_of(value.at("noise_floor"));
  return error;
}

std::optional<double> known(double value) {
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

ErrorGrowth growth_of(const Json& value) {
  const auto g = numbers_of(value, 5);
  const double stretches = g[1] > 0.0 ? g[1] : 0.0;
  return {g[0], static_cast<std::size_t>(std::min(stretches, 1e9)), known(g[2]), known(g[3]), known(g[4])};
}

ResidualTrace trace_of(const Json& value) {
  ResidualTrace trace;
  trace.effect = value.at("effect");
  trace.variable = value.at("variable");
  trace.variable_unit = value.at("variable_unit");
  trace.residual = value.at("residual");
  trace.residual_unit = value.at("residual_unit");
  trace.explained = number_of(value.at("explained"));
  for (const auto& point : value.at("points")) {
    const auto p = numbers_of(point, 3);
    trace.points.push_back({p[0], p[1], p[2]});
  }
  for (const auto& bin : value.at("bins")) {
    const auto b = numbers_of(bin, 5);
    trace.bins.push_back({b[0], b[1], b[2], b[3], b[4]});
  }
  return trace;
}

Detectable detectable_of(const Json& value) {
  Detectable effect{value.at("effect"), value.at("parameter"),          value.at("unit"),
                    std::nullopt,       number_of(value.at("typical")), value.at("motion")};
  if (!value.at("smallest").is_null()) effect.smallest = number_of(value.at("smallest"));
  return effect;
}

PathTrace path_of(const Json& value) {
  PathTrace path{value.at("name"), {}};
  for (const auto& point : value.at("points")) {
    const auto p = numbers_of(point, 3);
    path.points.push_back({p[0], p[1], p[2]});
  }
  return path;
}

ScanTrace scan_of(const Json& value) {
  ScanTrace scan;
  const auto before = numbers_of(value.at("before"), 3), after = numbers_of(value.at("after"), 3);
  scan.before = {before[0], before[1], before[2]};
  scan.after = {after[0], after[1], after[2]};
  for (const auto& point : value.at("points")) {
    const auto p = numbers_of(point, 2);
    scan.points.push_back({p[0], p[1]});
  }
  return scan;
}

ResidualAxis axis_of(const Json& value) {
  return {value.at("name"),
          value.at("unit"),
          number_of(value.at("mean")),
          number_of(value.at("std")),
          number_of(value.at("normalised")),
          number_of(value.at("autocorrelation")),
          number_of(value.at("runs")),
          value.at("histogram").get<std::vector<std::size_t>>(),
          number_of(value.value("reference_std", Json())),
          number_of(value.value("wheels_std", Json()))};
}

ResidualSample sample_of(const Json& value) {
  const auto s = numbers_of(value, 4);
  return {s[0], {s[1], s[2], s[3]}};
}

void read_errors(const Json& list, ReportData& data) {
  for (const auto& value : list) data.drive_errors.push_back(error_of(value));
}

void read_detectable(const Json& list, ReportData& data) {
  for (const auto& value : list) data.detectable.push_back(detectable_of(value));
}

void read_picture(const Json& picture, ReportData& data) {
  for (const auto& value : picture.value("growth", Json::array())) data.growth.push_back(growth_of(value));
  for (const auto& value : picture.at("paths")) data.paths.push_back(path_of(value));
  for (const auto& value : picture.value("scans", Json::array())) data.scans.push_back(scan_of(value));
  for (const auto& value : picture.at("traces")) data.traces.push_back(trace_of(value));
  for (const auto& value : picture.at("axes")) data.axes.push_back(axis_of(value));
  for (const auto& value : picture.at("series")) data.series.push_back(sample_of(value));
  for (const auto& [name, values] : picture.at("left_out").items())
    data.left_out.emplace_back(name, numbers_of(values, 0));
}

/// Calls `read` with the member's content; a member of another shape is as good as absent.
template <typename Read>
void read_member(const Calibration& calibration, const char* name, ReportData& data, Read read) {
  const auto member = calibration.extensions.find(name);
  if (member == calibration.extensions.end()) return;
  ReportData filled = data;
  try {
    read(Json::parse(member->second), filled);
    data = std::move(filled);
  } catch (const nlohmann::json::exception&) {
    return;
  }
}

}  // namespace

void store_report_data(const ReportData& data, Calibration& calibration) {
  Json left_out = Json::object();
  for (const auto& [name, values] : data.left_out) {
    left_out[name] = Json::array();
    for (const double value : values) left_out[name].push_back(rounded_number(value));
  }
  calibration.extensions[kErrorsMember] = list(data.drive_errors).dump();
  if (!data.detectable.empty()) calibration.extensions[kDetectableMember] = list(data.detectable).dump();
  calibration.extensions[kPictureMember] = Json{
      {"growth", list(data.growth)}, {"paths", list(data.paths)}, {"scans", list(data.scans)},
      {"traces", list(data.traces)}, {"axes", list(data.axes)},   {"series", list(data.series)},
      {"left_out", left_out}}.dump();
}

ReportData report_data_of(const Calibration& calibration) {
  ReportData data;
  read_member(calibration, kErrorsMember, data, read_errors);
  read_member(calibration, kDetectableMember, data, read_detectable);
  read_member(calibration, kPictureMember, data, read_picture);
  return data;
}

}  // namespace odomcalib
