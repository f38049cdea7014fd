#include "daemon/service/leg_report.hpp"

#include <cmath>
#include <numbers>

namespace odomcalib {
namespace {

ordered_json json_of(const routines::Pose& pose) { return {pose.x, pose.y, pose.yaw}; }

std::array<double, 3> lidar_pose(const std::optional<Calibration>& applied, const Config& config) {
  if (!applied || !applied->parameter("lidar_x")) return config.lidar_pose;
  return {*applied->parameter("lidar_x"), applied->parameter("lidar_y").value_or(0.0),
          applied->parameter("lidar_yaw").value_or(0.0)};
}

// Base motion between two moments at rest, in the frame of the first.
void add_motion(const Bench& bench, const Leg& from, const Leg& to, ordered_json& body) {
  const auto told = relative(from.before, to.after);
  body["odometry"] = json_of(told);
  body["lidar"] = nullptr;
  body["error"] = nullptr;
  if (!bench.calibrator.match || !from.scan_before || !to.scan_after) return;
  auto seen = bench.calibrator.match(*from.scan_before, *to.scan_after, told,
                                     lidar_pose(bench.applied.get(), bench.config));
  if (!seen) return;
  // The lidar cannot count full turns: the nearest to what the odometry says.
  const double difference = routines::wrapped(seen->yaw - told.yaw);
  seen->yaw = told.yaw + difference;
  body["lidar"] = json_of(*seen);
  body["error"] = {{"distance", std::hypot(told.x, told.y) - std::hypot(seen->x, seen->y)},
                   {"yaw", -difference}};
}

ordered_json leg_report(const Bench& bench, const Leg& leg) {
  ordered_json body = {{"move", leg.move.name}, {"begin", leg.begin}, {"end", leg.end}};
  add_motion(bench, leg, leg, body);
  body["wheels"] = wheel_turns(leg, bench.drive.robot().ticks_per_rev);
  return body;
}

ordered_json lengths(const RobotDescription& robot) {
  return {{"left_wheel_diameter", robot.left_wheel_diameter},
          {"right_wheel_diameter", robot.right_wheel_diameter},
          {"track_width", robot.track_width},
          {"ticks_per_rev", robot.ticks_per_rev}};
}

}  // namespace

std::array<double, 2> wheel_turns(const Leg& leg, double ticks_per_rev) {
  if (!(ticks_per_rev > 0.0)) return {};
  const double turn = 2.0 * std::numbers::pi / ticks_per_rev;
  return {turn * static_cast<double>(leg.ticks_after.left - leg.ticks_before.left),
          turn * static_cast<double>(leg.ticks_after.right - leg.ticks_before.right)};
}

ordered_json moves_report(const Bench& bench, const std::vector<Leg>& legs, std::size_t moves_in_round) {
  ordered_json body = {{"moves", ordered_json::array()}, {"robot", lengths(bench.drive.robot())}};
  for (const Leg& leg : legs) body["moves"].push_back(leg_report(bench, leg));
  if (moves_in_round == 0) return body;
  body["rounds"] = ordered_json::array();
  for (std::size_t k = 0; k + moves_in_round <= legs.size(); k += moves_in_round) {
    ordered_json round = ordered_json::object();
    add_motion(bench, legs[k], legs[k + moves_in_round - 1], round);
    body["rounds"].push_back(std::move(round));
  }
  return body;
}

}  // namespace odomcalib
