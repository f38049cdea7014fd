#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "proto/calibration/calibration.hpp"
#include "proto/calibration/scale.hpp"
#include "proto/calibration/utc.hpp"
#include "proto/discarded_json.hpp"

namespace odomcalib {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// A standard deviation that is negative was not estimated.
Json deviation(double value) { return value >= 0.0 ? number(value) : Json(nullptr); }

Json number(const std::optional<double>& value) { return value ? number(*value) : Json(nullptr); }

template <typename Range>
Json numbers(const Range& values) {
  Json out = Json::array();
  for (const double value : values) out.push_back(number(value));
  return out;
}

template <typename Rows>
Json matrix(const Rows& rows) {
  Json out = Json::array();
  for (const auto& row : rows) out.push_back(numbers(row));
  return out;
}

Json quantities(const QuantityList& list) {
  Json out = Json::object();
  for (const auto& [name, quantity] : list)
    out[name] = {
        {"value", number(quantity.value)}, {"std", deviation(quantity.std)}, {"unit", quantity.unit}};
  return out;
}

/// With the deviation in true metres, where the scale of the reference is known.
Json parameters(const Calibration& calibration) {
  Json out = quantities(calibration.parameters);
  if (const auto scale = scale_of(calibration))
    for (const auto& [name, quantity] : calibration.parameters)
      out[name]["std_absolute"] = deviation(absolute_deviation(quantity, *scale));
  return out;
}

Json robot(const RobotDescription& robot) {
  Json out{{"left_wheel_diameter", number(robot.left_wheel_diameter)},
           {"right_wheel_diameter", number(robot.right_wheel_diameter)},
           {"track_width", number(robot.track_width)},
           {"ticks_per_rev", number(robot.ticks_per_rev)},
           {"lidar_pose", robot.lidar_pose ? numbers(*robot.lidar_pose) : Json(nullptr)}};
  out["robot_id"] = robot.robot_id.empty() ? Json(nullptr) : Json(robot.robot_id);
  if (!robot.controller.empty()) out["controller"] = robot.controller;
  if (!robot.controller_id.empty()) out["controller_id"] = robot.controller_id;
  return out;
}

Json driven(const std::optional<Driven>& driven) {
  if (!driven) return nullptr;
  return {{"begin", utc_text(driven->begin)}, {"end", utc_text(driven->end)}};
}

Json linear_correction(const std::optional<LinearCorrection>& linear) {
  if (!linear) return nullptr;
  return {{"matrix", matrix(linear->matrix)},
          {"condition", number(linear->condition)},
          {"rms", numbers(linear->rms)}};
}

Json methods(const std::vector<MethodResult>& results) {
  Json out = Json::object();
  for (const auto& result : results) {
    if (result.refused)
      out[result.name] = {{"refused", *result.refused}};
    else
      out[result.name] = {{"parameters", quantities(result.parameters)},
                          {"rms", numbers(result.rms)},
                          {"used", result.used},
                          {"discarded", result.discarded}};
  }
  return out;
}

Json effects(const std::vector<EffectResult>& results) {
  Json out = Json::array();
  for (const auto& effect : results)
    out.push_back({{"name", effect.name},
                   {"parameters", quantities(effect.parameters)},
                   {"evidence",
                    {{"p_value", number(effect.evidence.p_value)},
                     {"held_out_before", number(effect.evidence.held_out_before)},
                     {"held_out_after", number(effect.evidence.held_out_after)}}},
                   {"aliases", effect.aliases},
                   {"stored_in", effect.stored_in}});
  return out;
}

Json unexplained(const std::optional<Unexplained>& rest) {
  if (!rest) return nullptr;
  return {
      {"depends_on", rest->depends_on}, {"p_value", number(rest->p_value)}, {"share", number(rest->share)}};
}

Json by_axis(const std::optional<std::array<double, 3>>& values) {
  if (!values) return nullptr;
  return {{"x", number((*values)[0])}, {"y", number((*values)[1])}, {"yaw", number((*values)[2])}};
}

Json residual(const ResidualReport& report) {
  return {{"held_out", report.held_out},
          {"before", by_axis(report.before)},
          {"after", by_axis(report.after)},
          {"noise_floor", by_axis(report.noise_floor)}};
}

Json counts(const std::vector<std::pair<std::string, std::size_t>>& list) {
  Json out = Json::object();
  for (const auto& [name, count] : list) out[name] = count;
  return out;
}

Json data(const std::vector<DataUse>& uses) {
  Json out = Json::array();
  for (const auto& use : uses) {
    out.push_back({{"file", use.name},
                   {"sha256", use.sha256},
                   {"begin", number(use.begin)},
                   {"duration", number(use.duration)},
                   {"counts", counts(use.counts)},
                   {"discarded", counts(use.discarded)}});
    if (!use.choices.empty()) out.back()["choices"] = use.choices;
    if (use.middleware != Middleware::none) out.back()["middleware"] = name_of(use.middleware);
  }
  return out;
}

/// Members of other modules, one line each: their points would fill pages. Text that is no JSON is kept as a
/// string, so that nothing gets lost silently.
std::string extension_lines(const Json& known, const std::map<std::string, std::string>& extensions) {
  std::string out;
  for (const auto& [name, text] : extensions) {
    if (known.contains(name)) continue;
    const Json parsed = Json::parse(text, nullptr, false);
    const Json value = parsed.is_discarded() ? Json(text) : parsed;
    out += ",\n  " + Json(name).dump(-1, ' ', false, Json::error_handler_t::replace) + ": " +
           value.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  return out;
}

}  // namespace

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::accepted:
      return "accepted";
    case Verdict::accepted_with_warnings:
      return "accepted_with_warnings";
    case Verdict::refused:
      break;
  }
  return "refused";
}

std::string to_json(const Calibration& calibration) {
  const Json out{
      {"format", "odomcalib-calibration/1"},
      {"verdict", name_of(calibration.verdict)},
      {"reasons", calibration.reasons},
      {"next_step", calibration.next_step.empty() ? Json() : Json(calibration.next_step)},
      {"robot", robot(calibration.robot)},
      {"driven", driven(calibration.driven)},
      {"parameters", parameters(calibration)},
      {"covariance", {{"order", calibration.covariance_order}, {"matrix", matrix(calibration.covariance)}}},
      {"linear_correction", linear_correction(calibration.linear_correction)},
      {"methods", methods(calibration.methods)},
      {"effects", effects(calibration.effects)},
      {"unexplained", unexplained(calibration.unexplained)},
      {"residual", residual(calibration.residual)},
      {"data", data(calibration.data)},
      {"discarded", to_json(calibration.discarded)},
      {"repairs", to_json(calibration.repairs)}};
  std::string text = out.dump(2, ' ', false, Json::error_handler_t::replace);
  text.insert(text.size() - 2, extension_lines(out, calibration.extensions));  // before the closing "\n}"
  return text + "\n";
}

}  // namespace odomcalib
