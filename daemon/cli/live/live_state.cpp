#include "daemon/cli/live/live_state.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "proto/base_quantities.hpp"
#include "proto/calibration/report_data.hpp"
#include "proto/wire/messages.hpp"

namespace odomcalib::cli {
namespace {

using nlohmann::ordered_json;

constexpr const char* kWithoutLcm =
    "scan and progress are asked for; calibrated odometry and results of a solve are missing";

// The daemon's answers are checked member by member: what is missing is empty, what is of another type too.
std::string text_in(const ordered_json& object, const char* member) {
  const auto found = object.find(member);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

ordered_json object_in(const ordered_json& object, const char* member) {
  const auto found = object.find(member);
  return found != object.end() && found->is_object() ? *found : ordered_json::object();
}

ordered_json number_in(const ordered_json& object, const char* member) {
  const auto found = object.find(member);
  return found != object.end() && found->is_number() ? *found : ordered_json();
}

std::optional<Pose> pose_of(const ordered_json& values) {
  if (!values.is_array() || values.size() != 3) return std::nullopt;
  for (const auto& value : values)
    if (!value.is_number()) return std::nullopt;
  return Pose{values[0].get<double>(), values[1].get<double>(), values[2].get<double>()};
}

ordered_json finite_or_null(double value) {
  return std::isfinite(value) ? ordered_json(value) : ordered_json();
}

double millimetres(double value) { return std::round(value * 1e3) / 1e3; }

ordered_json json_of(const Pose& pose) {
  return {millimetres(pose.x), millimetres(pose.y), std::round(pose.yaw * 1e4) / 1e4};
}

ordered_json json_of(const std::vector<Pose>& path, const std::optional<Pose>& now = std::nullopt) {
  ordered_json list = ordered_json::array();
  for (const Pose& pose : path) list.push_back({millimetres(pose.x), millimetres(pose.y)});
  if (now) list.push_back({millimetres(now->x), millimetres(now->y)});
  return list;
}

bool is_finite(const Pose& pose) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.yaw);
}

Pose pose_of(const PoseSample& sample) { return {sample.x, sample.y, sample.yaw}; }

/// A path of a result, in the frame of its first pose.
std::vector<Pose> path_of(const Calibration& calibration, const std::string& name) {
  std::vector<Pose> path;
  for (const PathTrace& trace : report_data_of(calibration).paths)
    if (trace.name == name)
      for (const auto& [x, y, yaw] : trace.points)
        if (const Pose pose{x, y, yaw}; is_finite(pose)) path.push_back(pose);
  if (path.empty()) return path;
  const Pose T_start_source = calib::math::inverse(path.front());
  for (Pose& pose : path) pose = calib::math::compose(T_start_source, pose);
  return path;
}

ordered_json row_of(const std::string& name, const std::string& unit) {
  return {{"name", name},      {"unit", unit},   {"value", nullptr},    {"calibrated", nullptr},
          {"solved", nullptr}, {"std", nullptr}, {"known_to", nullptr}, {"stored_in", "host"}};
}

ordered_json& row_in(ordered_json& rows, const std::string& name, const std::string& unit) {
  for (auto& row : rows)
    if (row["name"] == name) return row;
  rows.push_back(row_of(name, unit));
  return rows.back();
}

ordered_json progress_of(const ordered_json& body) {
  if (!body.is_object() || !number_in(body, "fraction").is_number()) return nullptr;
  return {{"phase", text_in(body, "phase")},
          {"fraction", std::clamp(body["fraction"].get<double>(), 0.0, 1.0)},
          {"eta", number_in(body, "eta")}};
}

/// Motion of the recording in progress, or of the last one, each stretch as long as a pair of scans.
struct Recorded {
  double straight = 0.0, straight_m = 0.0, turns = 0.0, turned_rad = 0.0;
};

Recorded recorded_in(const ordered_json& status) {
  const ordered_json motion = object_in(status, "recorded_motion");
  const auto amount = [&motion](const char* kind, const char* member) {
    const auto value = number_in(object_in(motion, kind), member);
    return value.is_number() ? value.get<double>() : 0.0;
  };
  return {amount("straight", "stretches"), amount("straight", "m"),
          amount("left", "stretches") + amount("right", "stretches"),
          amount("left", "rad") + amount("right", "rad")};
}

/// Two deviations that so much motion leaves, by the noise of each stretch alone; nullopt where it shows
/// nothing of the parameter.
std::optional<double> expected_deviation(const std::string& name, const ordered_json& value,
                                         const Recorded& recorded) {
  const bool drove = recorded.straight_m > 0.0, turned = recorded.turned_rad > 0.0;
  const double length = 2.0 * settings::kPairLength_m * std::sqrt(recorded.straight) / recorded.straight_m;
  const double turn = 2.0 * settings::kPairHeading_rad * std::sqrt(recorded.turns) / recorded.turned_rad;
  const auto quantity = base_quantity_from(name);
  if (!quantity) return std::nullopt;
  if (is_wheel_diameter(*quantity) && drove && value.is_number()) return value.get<double>() * length;
  if (quantity == BaseQuantity::track_width && drove && turned && value.is_number())
    return value.get<double>() * std::hypot(length, turn);
  if (quantity == BaseQuantity::lidar_yaw && drove) return length;
  if ((quantity == BaseQuantity::lidar_x || quantity == BaseQuantity::lidar_y) && turned)
    return 2.0 * settings::kPairLength_m * std::sqrt(recorded.turns) / recorded.turned_rad;
  return std::nullopt;
}

bool is_driving(const std::string& state) { return state.starts_with("moving") || state == "recording"; }

}  // namespace

void Trace::restart(const std::vector<Pose>& points) {
  points_.clear();
  spacing_ = kSpacing;
  now_.reset();
  from_source_.reset();
  for (const Pose& point : points) append(point);
  if (!points.empty()) now_ = points.back();
}

void Trace::continue_from(const Pose& source) {
  from_source_ = calib::math::compose(now_.value_or(Pose{}), calib::math::inverse(source));
}

void Trace::add(const Pose& source) {
  if (!from_source_) continue_from(source);
  now_ = calib::math::compose(*from_source_, source);
  append(*now_);
}

void Trace::append(const Pose& shown) {
  if (!points_.empty() && std::hypot(shown.x - points_.back().x, shown.y - points_.back().y) < spacing_)
    return;
  points_.push_back(shown);
  if (points_.size() < kMostPoints) return;
  spacing_ *= 2.0;
  for (std::size_t k = 1; 2 * k < points_.size(); ++k) points_[k] = points_[2 * k];
  points_.resize((points_.size() + 1) / 2);
}

void LiveState::connect(const ordered_json& description, bool lcm_opened) {
  connected_ = true;
  problem_.clear();
  lcm_url_ = text_in(object_in(description, "lcm"), "url");
  lcm_opened_ = lcm_opened;
  answers_without_message_ = 0;
  const ordered_json lidar = object_in(description, "lidar");
  nominal_lidar_ = pose_of(lidar.value("pose", ordered_json())).value_or(Pose{});
  // The frame of a daemon that was started again begins anew.
  last_odometry_.reset();
  last_calibrated_.reset();
  begin_drive();
}

void LiveState::disconnect(const std::string& why) {
  connected_ = drives_ = false;
  problem_ = why;
  progress_ = nullptr;
  scan_.clear();
  base_scan_.clear();
}

bool LiveState::needs_scan() const {
  return connected_ && (!lcm_opened_ || answers_without_message_ >= settings::kPatience);
}

void LiveState::take_scan_answer(const ordered_json& scan) {
  base_scan_.clear();
  scan_.clear();
  const auto points = scan.is_object() ? scan.value("points", ordered_json::array()) : ordered_json::array();
  for (const auto& point : points)
    if (point.is_array() && point.size() == 2 && point[0].is_number() && point[1].is_number() &&
        base_scan_.size() < kMostBeams)
      base_scan_.push_back({point[0].get<double>(), point[1].get<double>()});
}

void LiveState::take_status(const ordered_json& status) {
  if (!status.is_object()) return;
  status_ = status;
  const bool drove = std::exchange(drives_, is_driving(text_in(status, "state")));
  if (drives_ && !drove) begin_drive();
  if (text_in(status, "state") == "idle") progress_ = nullptr;
  if (!text_in(object_in(status, "lidar"), "stale").empty()) {
    scan_.clear();
    base_scan_.clear();
  }
  if (answers_without_message_ < settings::kPatience) ++answers_without_message_;
  if (!needs_scan()) return;
  // Progress and odometry are known without LCM.
  progress_ = progress_of(object_in(status, "progress"));
  if (const auto pose = pose_of(status.value("odometry", ordered_json()))) take_odometry(*pose);
}

void LiveState::take_parameters(const ordered_json& parameters) {
  if (parameters.is_array()) parameters_ = parameters;
}

void LiveState::take_message(std::string_view channel, std::string_view bytes) {
  answers_without_message_ = 0;
  if (channel == "SCAN") return take_scan(bytes);
  if (channel == "PROGRESS") return take_progress(bytes);
  if (channel == "RESULT") return take_result(bytes);
  const auto message = messages::decode_pose(bytes);
  if (!message || !is_finite(pose_of(message->pose))) return;
  if (channel == "ODOM") take_odometry(pose_of(message->pose));
  if (channel != "ODOM_CALIBRATED") return;
  last_calibrated_ = pose_of(message->pose);
  calibrated_.add(*last_calibrated_);
}

void LiveState::take_odometry(const Pose& pose) {
  last_odometry_ = pose;
  odometry_.add(pose);
}

void LiveState::take_scan(std::string_view bytes) {
  const auto message = messages::decode_scan(bytes);
  if (!message) return;
  const Scan& scan = message->scan;
  const std::size_t step = scan.ranges.size() / kMostBeams + 1;
  scan_.clear();
  base_scan_.clear();
  for (std::size_t k = 0; k < scan.ranges.size(); k += step) {
    const double range = static_cast<double>(scan.ranges[k]);
    const double angle = scan.angle(k);
    if (!std::isfinite(angle) || !(range > 0.0 && range >= scan.range_min && range <= scan.range_max))
      continue;
    scan_.push_back({range * std::cos(angle), range * std::sin(angle)});
  }
}

void LiveState::take_progress(std::string_view bytes) {
  const auto message = messages::decode_json(bytes);
  if (!message) return;
  const auto progress = progress_of(ordered_json::parse(message->json, nullptr, false));
  if (!progress.is_null()) progress_ = progress;
}

void LiveState::take_result(std::string_view bytes) {
  const auto message = messages::decode_json(bytes);
  if (!message) return;
  auto calibration = calibration_from_json(message->json, "RESULT");
  if (!calibration) return;
  result_ = std::move(calibration).value();
  // They are of one recording and one time; what follows continues from their ends.
  reference_ = path_of(*result_, "reference");
  if (reference_.size() > Trace::kMostPoints) {
    Trace thin;
    thin.restart(reference_);
    reference_ = thin.points();
  }
  if (const auto path = path_of(*result_, "odometry"); !path.empty()) {
    odometry_.restart(path);
    if (last_odometry_) odometry_.continue_from(*last_odometry_);
  }
  if (const auto path = path_of(*result_, "calibrated"); !path.empty()) {
    calibrated_.restart(path);
    if (last_calibrated_) calibrated_.continue_from(*last_calibrated_);
  }
}

void LiveState::begin_drive() {
  reference_.clear();
  odometry_.restart({Pose{}});
  if (last_odometry_) odometry_.continue_from(*last_odometry_);
  calibrated_.restart({});
  if (last_calibrated_) calibrated_.continue_from(*last_calibrated_);
}

std::string LiveState::why_no_telemetry() const {
  if (!connected_) return "";
  if (lcm_url_.empty())
    return "LCM is off in the daemon's configuration ([lcm] enabled): " + std::string(kWithoutLcm);
  if (!lcm_opened_) return "LCM cannot be opened here (" + lcm_url_ + "): " + kWithoutLcm;
  if (answers_without_message_ >= settings::kPatience)
    return "no LCM message arrives (" + lcm_url_ + "; see that multicast has a route): " + kWithoutLcm;
  return "";
}

Pose LiveState::lidar_pose() const {
  if (!result_) return nominal_lidar_;
  const auto x = result_->parameter(BaseQuantity::lidar_x), y = result_->parameter(BaseQuantity::lidar_y),
             yaw = result_->parameter(BaseQuantity::lidar_yaw);
  if (!x || !y || !yaw || !is_finite({*x, *y, *yaw})) return nominal_lidar_;
  return {*x, *y, *yaw};
}

ordered_json LiveState::parameter_rows() const {
  ordered_json rows = all_rows();
  const Recorded recorded = recorded_in(status_);
  for (auto& row : rows) {
    const auto std = row["std"];
    const auto known = std.is_number() ? std::optional(2.0 * std.get<double>())
                                       : expected_deviation(row["name"].get<std::string>(),
                                                            number_in(row, "value"), recorded);
    if (known) row["known_to"] = finite_or_null(*known);
  }
  return rows;
}

ordered_json LiveState::all_rows() const {
  ordered_json rows = ordered_json::array();
  for (const auto& parameter : parameters_) {
    if (!parameter.is_object() || text_in(parameter, "name").empty()) continue;
    ordered_json row = row_of(text_in(parameter, "name"), text_in(parameter, "unit"));
    row["value"] = number_in(parameter, "value");
    row["calibrated"] = number_in(parameter, "calibrated");
    row["stored_in"] = text_in(parameter, "stored_in");
    rows.push_back(row);
  }
  const std::array<double, 3> nominal = {nominal_lidar_.x, nominal_lidar_.y, nominal_lidar_.yaw};
  for (std::size_t k = 0; connected_ && k < nominal.size(); ++k) {
    const BaseQuantityRow& row = row_of(kLidarPoseQuantities.at(k));
    row_in(rows, row.name, row.unit)["value"] = nominal.at(k);
  }
  if (!result_) return rows;
  const auto add = [&rows](const std::string& name, const Quantity& quantity) {
    ordered_json& row = row_in(rows, name, quantity.unit);
    row["solved"] = finite_or_null(quantity.value);
    if (quantity.std >= 0.0) row["std"] = finite_or_null(quantity.std);
  };
  for (const auto& [name, quantity] : result_->parameters) add(name, quantity);
  for (const auto& effect : result_->effects)
    for (const auto& [name, quantity] : effect.parameters) add(effect.name + "." + name, quantity);
  return rows;
}

ordered_json LiveState::document() const {
  const ordered_json controller = object_in(status_, "controller"), lidar = object_in(status_, "lidar");
  ordered_json body = {{"format", "odomcalib-view/1"}, {"connected", connected_}, {"problem", problem_}};
  body["telemetry"] = why_no_telemetry();
  body["state"] = connected_ ? text_in(status_, "state") : "";
  body["progress"] = progress_;
  body["last_stop"] = text_in(status_, "last_stop");
  body["robot"] = text_in(object_in(status_, "robot"), "robot_id");
  body["supply_voltage"] = connected_ ? number_in(controller, "supply_voltage") : ordered_json();
  body["obstacle"] = connected_ ? text_in(status_, "obstacle") : "";
  body["controller"] = connected_ ? text_in(controller, "state") : "";
  body["lidar"] = connected_ ? text_in(lidar, "stale") : "";
  const auto& now = calibrated_.now() ? calibrated_.now() : odometry_.now();
  body["pose"] = now ? json_of(*now) : ordered_json();
  body["paths"] = {{"odometry", json_of(odometry_.points(), odometry_.now())},
                   {"calibrated", json_of(calibrated_.points(), calibrated_.now())},
                   {"reference", json_of(reference_)}};
  body["scan"] = ordered_json::array();
  for (const auto& [x, y] : scan_) {
    const Pose point = calib::math::compose(lidar_pose(), Pose{x, y, 0.0});
    body["scan"].push_back({millimetres(point.x), millimetres(point.y)});
  }
  for (const auto& [x, y] : base_scan_) body["scan"].push_back({millimetres(x), millimetres(y)});
  body["verdict"] = result_ ? ordered_json(name_of(result_->verdict)) : ordered_json();
  body["parameters"] = parameter_rows();
  return body;
}

}  // namespace odomcalib::cli
