#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string_view>

#include "proto/calibration/calibration.hpp"
#include "proto/calibration/utc.hpp"

namespace odomcalib {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kFormatOfAnyVersion = "odomcalib-calibration/";
constexpr std::string_view kFormat = "odomcalib-calibration/1";
constexpr std::array<std::string_view, 16> kCalibrationMembers{
    "format",     "verdict",    "reasons",           "next_step", "driven",  "robot",
    "parameters", "covariance", "linear_correction", "methods",   "effects", "unexplained",
    "residual",   "data",       "discarded",         "repairs"};
constexpr int kDeepestCalibration = 64;

/// One JSON value and its path. Wrong types are noted once, in `problem`, and read as empty values.
class Node {
 public:
  Node(const Json& json, std::string path, std::string& problem)
      : json_(&json), path_(std::move(path)), problem_(&problem) {}

  [[nodiscard]] bool is_null() const { return json_->is_null(); }
  [[nodiscard]] Node operator[](const char* name) const {
    static const Json kNull;
    const std::string path = path_.empty() ? std::string(name) : path_ + "." + name;
    if (json_->is_null()) return {kNull, path, *problem_};
    if (!expect(json_->is_object(), "an object")) return {kNull, path, *problem_};
    const auto found = json_->find(name);
    return {found == json_->end() ? kNull : *found, path, *problem_};
  }

  /// NaN for null: a value that was not finite when it was written.
  [[nodiscard]] double number() const {
    if (is_null() || !expect(json_->is_number(), "a number")) return std::numeric_limits<double>::quiet_NaN();
    return json_->get<double>();
  }
  [[nodiscard]] std::optional<double> optional_number() const {
    return is_null() ? std::nullopt : std::optional(number());
  }
  [[nodiscard]] std::string text() const {
    return !is_null() && expect(json_->is_string(), "a text") ? json_->get<std::string>() : std::string();
  }
  [[nodiscard]] bool flag(bool absent) const {
    return !is_null() && expect(json_->is_boolean(), "true or false") ? json_->get<bool>() : absent;
  }
  [[nodiscard]] std::size_t count() const {
    return !is_null() && expect(json_->is_number_unsigned(), "a count") ? json_->get<std::size_t>() : 0;
  }
  /// Calls `visit(Node)` for each element; null is an empty list.
  template <typename Visit>
  void each(Visit visit) const {
    if (is_null() || !expect(json_->is_array(), "a list")) return;
    for (std::size_t i = 0; i < json_->size(); ++i)
      visit(Node((*json_)[i], path_ + "[" + std::to_string(i) + "]", *problem_));
  }
  /// Calls `visit(name, Node)` for each member; null is an empty object.
  template <typename Visit>
  void each_member(Visit visit) const {
    if (is_null() || !expect(json_->is_object(), "an object")) return;
    for (const auto& [name, value] : json_->items()) visit(name, Node(value, path_ + "." + name, *problem_));
  }
  bool expect(bool holds, const std::string& what) const {
    if (!holds && problem_->empty()) *problem_ = "\"" + path_ + "\" is not " + what;
    return holds;
  }

 private:
  const Json* json_;
  std::string path_;
  std::string* problem_;
};

std::vector<double> read_numbers(const Node& node) {
  std::vector<double> out;
  node.each([&](const Node& element) { out.push_back(element.number()); });
  return out;
}

std::array<double, 3> triple(const Node& node) {
  const auto values = read_numbers(node);
  std::array<double, 3> out{};
  if (!node.is_null() && node.expect(values.size() == 3, "three numbers"))
    std::copy(values.begin(), values.end(), out.begin());
  return out;
}

std::vector<std::string> texts(const Node& node) {
  std::vector<std::string> out;
  node.each([&](const Node& element) { out.push_back(element.text()); });
  return out;
}

QuantityList read_quantities(const Node& node) {
  QuantityList out;
  node.each_member([&](const std::string& name, const Node& value) {
    out.emplace_back(name, Quantity{value["value"].number(), value["std"].optional_number().value_or(-1.0),
                                    value["unit"].text()});
  });
  return out;
}

RobotDescription read_robot(const Node& node) {
  RobotDescription out;
  out.left_wheel_diameter = node["left_wheel_diameter"].optional_number().value_or(0.0);
  out.right_wheel_diameter = node["right_wheel_diameter"].optional_number().value_or(0.0);
  out.track_width = node["track_width"].optional_number().value_or(0.0);
  out.ticks_per_rev = node["ticks_per_rev"].optional_number().value_or(0.0);
  if (!node["lidar_pose"].is_null()) out.lidar_pose = triple(node["lidar_pose"]);
  out.robot_id = node["robot_id"].text();
  out.controller = node["controller"].text();
  out.controller_id = node["controller_id"].text();
  return out;
}

std::optional<Driven> read_driven(const Node& node) {
  if (node.is_null()) return std::nullopt;
  const auto begin = utc_from(node["begin"].text()), end = utc_from(node["end"].text());
  if (!node.expect(begin && end, "two times like 2026-05-04T12:30:00Z")) return std::nullopt;
  return Driven{*begin, *end};
}

std::optional<LinearCorrection> read_linear_correction(const Node& node) {
  if (node.is_null()) return std::nullopt;
  LinearCorrection out;
  std::size_t row = 0;
  node["matrix"].each([&](const Node& values) {
    if (row < 3) out.matrix.at(row) = triple(values);
    ++row;
  });
  node["matrix"].expect(row == 3, "three rows");
  out.condition = node["condition"].number();
  out.rms = triple(node["rms"]);
  return out;
}

std::vector<MethodResult> read_methods(const Node& node) {
  std::vector<MethodResult> out;
  node.each_member([&](const std::string& name, const Node& value) {
    MethodResult result;
    result.name = name;
    if (!value["refused"].is_null()) result.refused = value["refused"].text();
    result.parameters = read_quantities(value["parameters"]);
    result.rms = triple(value["rms"]);
    result.used = value["used"].count();
    result.discarded = value["discarded"].count();
    out.push_back(std::move(result));
  });
  return out;
}

std::vector<EffectResult> read_effects(const Node& node) {
  std::vector<EffectResult> out;
  node.each([&](const Node& value) {
    EffectResult effect;
    effect.name = value["name"].text();
    effect.parameters = read_quantities(value["parameters"]);
    const auto evidence = value["evidence"];
    effect.evidence = {evidence["p_value"].number(), evidence["held_out_before"].optional_number(),
                       evidence["held_out_after"].optional_number()};
    effect.aliases = texts(value["aliases"]);
    effect.stored_in = value["stored_in"].text();
    out.push_back(std::move(effect));
  });
  return out;
}

std::optional<Unexplained> read_unexplained(const Node& node) {
  if (node.is_null()) return std::nullopt;
  return Unexplained{texts(node["depends_on"]), node["p_value"].number(), node["share"].number()};
}

std::optional<std::array<double, 3>> read_by_axis(const Node& node) {
  if (node.is_null()) return std::nullopt;
  return std::array<double, 3>{node["x"].number(), node["y"].number(), node["yaw"].number()};
}

ResidualReport read_residual(const Node& node) {
  return {node["held_out"].flag(true), read_by_axis(node["before"]), read_by_axis(node["after"]),
          read_by_axis(node["noise_floor"])};
}

Verdict verdict(const Node& node) {
  const auto name = node.text();
  if (name == "accepted") return Verdict::accepted;
  if (name == "accepted_with_warnings") return Verdict::accepted_with_warnings;
  node.expect(name == "refused", "a known verdict");
  return Verdict::refused;
}

std::vector<std::pair<std::string, std::size_t>> read_counts(const Node& node) {
  std::vector<std::pair<std::string, std::size_t>> out;
  node.each_member(
      [&](const std::string& name, const Node& value) { out.emplace_back(name, value.count()); });
  return out;
}

/// Files of earlier versions do not state it: there a choice names the type of the messages, as ROS 2 writes
/// it.
Middleware read_middleware(const Node& node, const std::vector<std::string>& choices) {
  const std::string name = node.text();
  for (const Middleware one : {Middleware::ros1, Middleware::ros2})
    if (name == name_of(one)) return one;
  const bool names_ros2 = std::any_of(choices.begin(), choices.end(), [](const std::string& choice) {
    return choice.find("/msg/") != std::string::npos;
  });
  return names_ros2 ? Middleware::ros2 : Middleware::none;
}

std::vector<DataUse> read_data_uses(const Node& node) {
  std::vector<DataUse> out;
  node.each([&](const Node& value) {
    out.push_back({value["file"].text(), value["sha256"].text(), value["begin"].optional_number(),
                   value["duration"].optional_number().value_or(0.0), read_counts(value["counts"]),
                   read_counts(value["discarded"]), texts(value["choices"])});
    out.back().middleware = read_middleware(value["middleware"], out.back().choices);
  });
  return out;
}

std::vector<Discarded> read_discarded(const Node& node) {
  std::vector<Discarded> out;
  node.each([&](const Node& value) {
    out.push_back({value["what"].text(), value["reason"].text(), value["count"].count(), value["of"].count(),
                   value["begin"].optional_number(), value["end"].optional_number()});
  });
  return out;
}

std::vector<Repair> read_repairs(const Node& node) {
  std::vector<Repair> out;
  node.each([&](const Node& value) {
    out.push_back({value["what"].text(), value["chosen"].text(), value["reason"].text()});
  });
  return out;
}

std::map<std::string, std::string> extensions(const Json& json) {
  std::map<std::string, std::string> out;
  for (const auto& [name, value] : json.items())
    if (std::find(kCalibrationMembers.begin(), kCalibrationMembers.end(), name) == kCalibrationMembers.end())
      out[name] = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  return out;
}

/// Refuses deep nesting while parsing, before it costs memory.
Json parse_calibration(const std::string& text) {
  bool too_deep = false;
  const auto guard = [&](int depth, Json::parse_event_t, Json&) {
    too_deep = too_deep || depth > kDeepestCalibration;
    return !too_deep;
  };
  auto json = Json::parse(text, guard, false);
  return too_deep || json.is_discarded() ? Json() : json;
}

Calibration calibration(const Json& json, std::string& problem) {
  const Node root(json, "", problem);
  Calibration out;
  out.robot = read_robot(root["robot"]);
  out.driven = read_driven(root["driven"]);
  out.parameters = read_quantities(root["parameters"]);
  out.covariance_order = texts(root["covariance"]["order"]);
  root["covariance"]["matrix"].each([&](const Node& row) { out.covariance.push_back(read_numbers(row)); });
  out.linear_correction = read_linear_correction(root["linear_correction"]);
  out.methods = read_methods(root["methods"]);
  out.effects = read_effects(root["effects"]);
  out.unexplained = read_unexplained(root["unexplained"]);
  out.residual = read_residual(root["residual"]);
  out.verdict = verdict(root["verdict"]);
  out.reasons = texts(root["reasons"]);
  out.next_step = root["next_step"].text();
  out.data = read_data_uses(root["data"]);
  out.discarded = read_discarded(root["discarded"]);
  out.repairs = read_repairs(root["repairs"]);
  out.extensions = extensions(json);
  return out;
}

/// The covariance belongs to the named parameters: a matrix of another size cannot be read.
bool covariance_fits(const Calibration& calibration) {
  const std::size_t size = calibration.covariance_order.size();
  return (calibration.covariance.empty() && size == 0) ||
         (calibration.covariance.size() == size &&
          std::all_of(calibration.covariance.begin(), calibration.covariance.end(),
                      [size](const auto& row) { return row.size() == size; }));
}

std::optional<std::string> non_finite(const QuantityList& quantities, const std::string& path) {
  for (const auto& [name, quantity] : quantities)
    if (!std::isfinite(quantity.value)) return std::string(path).append(".").append(name);
  return std::nullopt;
}

}  // namespace

std::optional<std::string> non_finite_value(const Calibration& calibration) {
  if (auto path = non_finite(calibration.parameters, "parameters")) return path;
  for (const EffectResult& effect : calibration.effects)
    if (auto path = non_finite(effect.parameters, "effects." + effect.name)) return path;
  return std::nullopt;
}

Result<Calibration> calibration_from_json(const std::string& text, const std::string& where) {
  return calibration_from(parse_calibration(text), where);
}

Result<Calibration> calibration_from(const Json& json, const std::string& where) {
  if (!json.is_object())
    return Error{ErrorCode::format, "is not a calibration file (no JSON object)", where,
                 "name a file that solve wrote"};
  std::string problem;
  const std::string format = Node(json, "", problem)["format"].text();
  if (format != kFormat && format.starts_with(kFormatOfAnyVersion))
    return Error{ErrorCode::format, std::string(kOtherVersion) + ": \"" + format + "\"", where,
                 "update odomcalib, or solve the recording with this version"};
  if (format != kFormat)
    return Error{ErrorCode::format,
                 "is not a calibration file (\"format\" is not \"odomcalib-calibration/1\")", where,
                 "name a file that solve wrote"};
  auto out = calibration(json, problem);
  if (problem.empty() && !covariance_fits(out))
    problem = "\"covariance\" has a matrix that does not fit its order";
  if (!problem.empty())
    return Error{ErrorCode::format, "calibration file is damaged: " + problem, where,
                 "solve the recording again"};
  return out;
}

}  // namespace odomcalib
