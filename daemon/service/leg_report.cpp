#include "daemon/service/leg_report.hpp"

#include <cmath>

namespace odomcalib {
namespace {

ordered_json json_of(const routines::Pose& pose) { return {pose.x, pose.y, pose.yaw}; }

std::array<double, 3> lidar_pose(const std::optional<Calibration>& applied, const Config& config) {
  if (!applied || !applied->parameter("lidar_x")) return config.lidar_pose;
  return {*applied->parameter("lidar_x"), applied->parameter("lidar_y").value_or(0.0),
          applied->parameter("lidar_yaw").value_or(0.0)};
}

// Base motion in the frame of the move's start.
ordered_json leg_report(const Bench& bench, const Leg& leg) {
  const auto told = relative(leg.before, leg.after);
  ordered_json body = {
      {"move", leg.move.name}, {"begin", leg.begin}, {"end", leg.end}, {"odometry", json_of(told)}};
  body["lidar"] = nullptr;
  body["error"] = nullptr;
  if (!bench.calibrator.match || !leg.scan_before || !leg.scan_after) return body;
  auto seen = bench.calibrator.match(*leg.scan_before, *leg.scan_after, told,
                                     lidar_pose(bench.applied.get(), bench.config));
  if (!seen) return body;
  // The lidar cannot count full turns: the nearest to what the odometry says.
  const double difference = routines::wrapped(seen->yaw - told.yaw);
  seen->yaw = told.yaw + difference;
  body["lidar"] = json_of(*seen);
  body["error"] = {{"distance", std::hypot(told.x, told.y) - std::hypot(seen->x, seen->y)},
                   {"yaw", -difference}};
  return body;
}

}  // namespace

ordered_json moves_report(const Bench& bench, const std::vector<Leg>& legs) {
  ordered_json moves = ordered_json::array();
  for (const Leg& leg : legs) moves.push_back(leg_report(bench, leg));
  return {{"moves", moves}};
}

}  // namespace odomcalib
