#include "daemon/service/leg_report.hpp"

#include <algorithm>
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

/// Base motion from rest to rest by the lidar, the mean over pairs of scans; nullopt when no pair matches.
std::optional<routines::Pose> seen_motion(const Bench& bench, const Leg& from, const Leg& to,
                                          const routines::Pose& told) {
  const auto mount = lidar_pose(bench.applied.get(), bench.config);
  const std::size_t pairs = std::min(from.scans_before.size(), to.scans_after.size());
  routines::Pose sum;
  double count = 0.0;
  for (std::size_t k = 0; k < pairs; ++k) {
    const auto seen = bench.calibrator.match(from.scans_before[k], to.scans_after[k], told, mount);
    if (!seen) continue;
    // The lidar cannot count full turns: the nearest to what the odometry says.
    sum = {sum.x + seen->x, sum.y + seen->y, sum.yaw + told.yaw + routines::wrapped(seen->yaw - told.yaw)};
    ++count;
  }
  if (count == 0.0) return std::nullopt;
  return routines::Pose{sum.x / count, sum.y / count, sum.yaw / count};
}

// Base motion between two moments at rest, in the frame of the first.
void add_motion(const Bench& bench, const Leg& from, const Leg& to, ordered_json& body) {
  const auto told = relative(from.before, to.after);
  body["odometry"] = json_of(told);
  body["lidar"] = nullptr;
  body["error"] = nullptr;
  if (!bench.calibrator.match) return;
  const auto seen = seen_motion(bench, from, to, told);
  if (!seen) return;
  body["lidar"] = json_of(*seen);
  body["error"] = {{"distance", std::hypot(told.x, told.y) - std::hypot(seen->x, seen->y)},
                   {"yaw", told.yaw - seen->yaw}};
}

/// @param is_matched false where nobody needs the lidar's view of single moves, which takes the loop some 50
/// ms each
ordered_json leg_report(const Bench& bench, const Leg& leg, bool is_matched) {
  ordered_json body = {{"move", leg.move.name}, {"begin", leg.begin},
                       {"end", leg.end},        {"odometry", json_of(relative(leg.before, leg.after))},
                       {"lidar", nullptr},      {"error", nullptr}};
  if (is_matched) add_motion(bench, leg, leg, body);
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
  for (const Leg& leg : legs) body["moves"].push_back(leg_report(bench, leg, moves_in_round == 0));
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
