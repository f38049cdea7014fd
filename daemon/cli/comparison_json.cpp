#include <nlohmann/json.hpp>

#include "daemon/cli/comparison_document.hpp"
#include "proto/calibration/utc.hpp"

namespace odomcalib::cli {
namespace {

namespace comparison = calib::comparison;
using nlohmann::ordered_json;

ordered_json finite_or_null(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

const char* name_of(comparison::Metre metre) {
  if (metre == comparison::Metre::unstated) return "unstated";
  return metre == comparison::Metre::common ? "common" : "apart";
}

const char* name_of(TrendAxis::Kind kind) {
  if (kind == TrendAxis::Kind::date) return "date";
  return kind == TrendAxis::Kind::distance ? "distance" : "number";
}

ordered_json object_of(const comparison::JointTest& test) {
  return {{"statistic", test.statistic}, {"freedom", test.freedom}, {"p_value", test.p_value}};
}

ordered_json object_of(const std::optional<comparison::Estimate>& estimate) {
  if (!estimate) return nullptr;
  return {{"value", estimate->value}, {"std", estimate->std}};
}

ordered_json object_of(const std::vector<comparison::Change>& changes) {
  ordered_json out = ordered_json::object();
  for (const comparison::Change& one : changes)
    out[one.name] = {{"before", one.before},   {"after", one.after},        {"change", one.difference()},
                     {"std", one.std},         {"unit", one.unit},          {"deviations", one.deviations()},
                     {"p_value", one.p_value}, {"changed", one.is_change()}};
  return out;
}

ordered_json names_of(const std::vector<comparison::LoneEffect>& effects) {
  ordered_json names = ordered_json::array();
  for (const comparison::LoneEffect& effect : effects) names.push_back(effect.name);
  return names;
}

void add_lone(ordered_json& all, const std::vector<comparison::LoneEffect>& effects, bool came) {
  for (const comparison::LoneEffect& effect : effects) {
    const bool known = effect.smallest.has_value();
    const Quantity& value = effect.value.quantity;
    all.push_back({{"effect", effect.name},
                   {"came", came},
                   {"changed", effect.is_change()},
                   {"p_value", known ? ordered_json(effect.p_value) : ordered_json(nullptr)},
                   {"value_of", known ? ordered_json(effect.value.name) : ordered_json(nullptr)},
                   {"value", known ? ordered_json(value.value) : ordered_json(nullptr)},
                   {"unit", known ? ordered_json(value.unit) : ordered_json(nullptr)},
                   {"smallest", known ? ordered_json(*effect.smallest) : ordered_json(nullptr)}});
  }
}

ordered_json in_one_of(const comparison::Difference& difference) {
  ordered_json all = ordered_json::array();
  add_lone(all, difference.came, true);
  add_lone(all, difference.went, false);
  return all;
}

ordered_json object_of(const comparison::Difference& difference, const ComparedFile& from,
                       const ComparedFile& to) {
  return {{"from", from.path},
          {"to", to.path},
          {"changed", difference.is_change()},
          {"joint", object_of(difference.joint)},
          {"metre", name_of(difference.metre)},
          {"parameters", object_of(difference.parameters)},
          {"metre_error", object_of(difference.metre_error)},
          {"turn_error", object_of(difference.turn_error)},
          {"effects", object_of(difference.effects)},
          {"came", names_of(difference.came)},
          {"went", names_of(difference.went)},
          {"in_one_only", in_one_of(difference)}};
}

ordered_json object_of(const ComparedFile& file) {
  const Calibration& calibration = file.calibration;
  ordered_json out = {
      {"file", file.path},
      {"driven", nullptr},
      {"odometer", nullptr},
      {"verdict", odomcalib::name_of(calibration.verdict)},
      {"left_out", file.left_out.empty() ? ordered_json(nullptr) : ordered_json(file.left_out)}};
  if (const auto& driven = calibration.driven)
    out["driven"] = {{"begin", utc_text(driven->begin)}, {"end", utc_text(driven->end)}};
  if (const auto odometer = calibration.odometer) out["odometer"] = finite_or_null(*odometer);
  ordered_json parameters = ordered_json::object();
  for (const auto& [name, quantity] : calibration.parameters)
    parameters[name] = {{"value", finite_or_null(quantity.value)},
                        {"std", quantity.std >= 0.0 ? finite_or_null(quantity.std) : ordered_json(nullptr)},
                        {"unit", quantity.unit}};
  out["parameters"] = std::move(parameters);
  return out;
}

/// A date as such, other places in their unit.
ordered_json place_on(const TrendAxis& axis, const std::optional<double>& x) {
  if (!x) return nullptr;
  if (axis.kind != TrendAxis::Kind::date) return finite_or_null(*x);
  const double t = axis.zero + *x * kDay_s;
  return is_date(t) ? ordered_json(utc_text(t)) : ordered_json(nullptr);
}

ordered_json passes(const TrendOverAxis& trend, const std::optional<double>& bound) {
  const auto found = bound ? comparison::passing(trend.parameters, *bound) : std::nullopt;
  if (!found) return nullptr;
  return {{"at", place_on(trend.axis, found->at)},
          {"earliest", place_on(trend.axis, found->earliest)},
          {"latest", place_on(trend.axis, found->latest)}};
}

ordered_json object_of(const TrendOverAxis& trend, const std::optional<double>& bound) {
  ordered_json parameters = ordered_json::object();
  for (const auto& one : trend.parameters)
    if (one.line)
      parameters[one.name] = {{"slope", one.line->slope},
                              {"std", one.line->slope_std},
                              {"unit", one.unit},
                              {"p_value", one.line->p_value},
                              {"significant", one.line->is_significant()},
                              {"scatter", one.line->scatter}};
  const bool dated = trend.axis.kind == TrendAxis::Kind::date;
  return {{"over", name_of(trend.axis.kind)},
          {"zero", dated ? ordered_json(utc_text(trend.axis.zero)) : ordered_json(nullptr)},
          {"x", trend.axis.x},
          {"parameters", std::move(parameters)},
          {"passes", passes(trend, bound)}};
}

ordered_json object_of(const ComparedRobot& robot, const ComparisonOptions& options) {
  ordered_json files = ordered_json::array(), steps = ordered_json::array(), trends = ordered_json::array();
  for (const ComparedFile& file : robot.files) files.push_back(object_of(file));
  for (std::size_t k = 0; k < robot.steps.size(); ++k)
    steps.push_back(object_of(robot.steps[k], robot.usable_file(k), robot.usable_file(k + 1)));
  for (const TrendOverAxis& trend : robot.trends)
    if (options.trend) trends.push_back(object_of(trend, options.bound));
  ordered_json out = {
      {"robot_id", robot.robot_id.empty() ? ordered_json(nullptr) : ordered_json(robot.robot_id)},
      {"order", robot.by_date ? "date" : "as_named"},
      {"state", comparison::name_of(robot.standing.urgency)},
      {"calibrations", std::move(files)},
      {"homogeneity", object_of(robot.all)},
      {"steps", std::move(steps)},
      {"overall", nullptr},
      {"trends", std::move(trends)}};
  if (robot.overall)
    out["overall"] =
        object_of(*robot.overall, robot.usable_file(0), robot.usable_file(robot.usable.size() - 1));
  return out;
}

}  // namespace

ordered_json to_json(const std::vector<ComparedRobot>& robots, const ComparisonOptions& options) {
  ordered_json all = ordered_json::array();
  for (const ComparedRobot& robot : robots) all.push_back(object_of(robot, options));
  return {{"by_robot", options.by_robot},
          {"until", options.bound ? ordered_json(*options.bound) : ordered_json(nullptr)},
          {"robots", std::move(all)}};
}

}  // namespace odomcalib::cli
