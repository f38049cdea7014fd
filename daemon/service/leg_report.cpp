#include "daemon/service/leg_report.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "daemon/service/dead_reckoning.hpp"
#include "proto/base_quantities.hpp"
#include "proto/calibration/utc.hpp"

namespace odomcalib {
namespace {

ordered_json json_of(const routines::Pose& pose) { return {pose.x, pose.y, pose.yaw}; }

/// Members without those that nobody knows.
ordered_json description(const RobotDescription& robot) {
  ordered_json body;
  for (const BaseQuantity length : kDriveLengths) body[name_of(length)] = robot.*member_of(length);
  body["ticks_per_rev"] = robot.ticks_per_rev;
  if (robot.lidar_pose) body["lidar_pose"] = *robot.lidar_pose;
  if (!robot.robot_id.empty()) body["robot_id"] = robot.robot_id;
  if (!robot.controller.empty()) body["controller"] = robot.controller;
  if (!robot.controller_id.empty()) body["controller_id"] = robot.controller_id;
  return body;
}

}  // namespace

std::array<double, 3> lidar_pose(const std::optional<Calibration>& applied, const Config& config) {
  if (!applied || !applied->parameter(BaseQuantity::lidar_x)) return config.lidar_pose;
  std::array<double, 3> pose{};
  for (std::size_t k = 0; k < pose.size(); ++k)
    pose.at(k) = applied->parameter(kLidarPoseQuantities.at(k)).value_or(0.0);
  return pose;
}

std::array<double, 2> wheel_turns(const Leg& leg, double ticks_per_rev) {
  if (!(ticks_per_rev > 0.0)) return {};
  const double turn = 2.0 * std::numbers::pi / ticks_per_rev;
  return {turn * static_cast<double>(leg.ticks_after.left - leg.ticks_before.left),
          turn * static_cast<double>(leg.ticks_after.right - leg.ticks_before.right)};
}

MovesReport::MovesReport(const Calibrator& calibrator, std::vector<Leg> legs, std::size_t moves_in_round)
    : calibrator_(calibrator), legs_(std::move(legs)), in_rounds_(moves_in_round != 0) {
  const std::size_t together = in_rounds_ ? moves_in_round : 1;
  for (std::size_t k = 0; k + together <= legs_.size(); k += together) {
    const Leg &first = legs_[k], &last = legs_[k + together - 1];
    const std::size_t pairs =
        calibrator.match ? std::min(first.scans_before.size(), last.scans_after.size()) : 0;
    comparisons_.push_back({k, k + together - 1, relative(first.before, last.after), pairs});
  }
}

bool MovesReport::compare_next(const std::array<double, 3>& lidar_pose) {
  while (next_ < comparisons_.size() && comparisons_[next_].tried == comparisons_[next_].pairs) ++next_;
  if (next_ == comparisons_.size()) return false;
  Comparison& now = comparisons_[next_];
  const auto seen = calibrator_.match(legs_[now.from].scans_before[now.tried],
                                      legs_[now.to].scans_after[now.tried], now.by_odometry, lidar_pose);
  ++now.tried;
  if (!seen) return true;
  // The lidar cannot count full turns: the nearest to what the odometry says.
  const double yaw = now.by_odometry.yaw + routines::wrapped(seen->yaw - now.by_odometry.yaw);
  now.sum = {now.sum.x + seen->x, now.sum.y + seen->y, now.sum.yaw + yaw};
  ++now.matched;
  return true;
}

/// The lidar's motion is the mean over pairs of scans; null when no pair matches.
void MovesReport::add(const Comparison& comparison, ordered_json& body) {
  const routines::Pose &driven = comparison.by_odometry, &sum = comparison.sum;
  body["odometry"] = json_of(driven);
  body["lidar"] = nullptr;
  body["error"] = nullptr;
  if (comparison.matched == 0) return;
  const auto count = static_cast<double>(comparison.matched);
  const routines::Pose seen{sum.x / count, sum.y / count, sum.yaw / count};
  body["lidar"] = json_of(seen);
  body["error"] = {{"distance", std::hypot(driven.x, driven.y) - std::hypot(seen.x, seen.y)},
                   {"yaw", driven.yaw - seen.yaw}};
}

ordered_json MovesReport::body(const RobotDescription& robot, double since_1970) const {
  ordered_json body = {{"moves", ordered_json::array()}, {"robot", description(robot)}};
  if (!legs_.empty() && is_date(since_1970 + legs_.front().begin))
    body["driven"] = {{"begin", utc_text(since_1970 + legs_.front().begin)},
                      {"end", utc_text(since_1970 + legs_.back().end)}};
  for (std::size_t k = 0; k < legs_.size(); ++k) {
    const Leg& leg = legs_[k];
    ordered_json move = {{"move", leg.move.name}, {"begin", leg.begin}, {"end", leg.end}};
    add(in_rounds_ ? Comparison{k, k, relative(leg.before, leg.after), 0} : comparisons_[k], move);
    move["wheels"] = wheel_turns(leg, robot.ticks_per_rev);
    body["moves"].push_back(std::move(move));
  }
  if (!in_rounds_) return body;
  body["rounds"] = ordered_json::array();
  for (const Comparison& comparison : comparisons_) {
    ordered_json round = ordered_json::object();
    add(comparison, round);
    body["rounds"].push_back(std::move(round));
  }
  return body;
}

}  // namespace odomcalib
