#include "daemon/service/dead_reckoning.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "daemon/service/settings.hpp"

namespace odomcalib {

std::optional<Increment> increment_between(const TickSample& from, const TickSample& to,
                                           const RobotDescription& robot) {
  const bool known = robot.ticks_per_rev > 0.0 && robot.track_width > 0.0;
  if (from.segment != to.segment || !known) return std::nullopt;
  const double per_tick = std::numbers::pi / robot.ticks_per_rev;
  const double left = static_cast<double>(to.left - from.left) * per_tick * robot.left_wheel_diameter;
  const double right = static_cast<double>(to.right - from.right) * per_tick * robot.right_wheel_diameter;
  return Increment{0.5 * (left + right), (right - left) / robot.track_width};
}

void DeadReckoning::add(const TickSample& sample, const RobotDescription& robot) {
  if (const auto step = last_ ? increment_between(*last_, sample, robot) : std::nullopt) {
    const double middle = pose_.yaw + 0.5 * step->turn;
    pose_.x += step->forward * std::cos(middle);
    pose_.y += step->forward * std::sin(middle);
    pose_.yaw += step->turn;
  }
  last_ = sample;
  past_.push_back({sample.t, pose_});
  while (past_.size() > 2 && sample.t - past_[1].t > service::settings::kPoseMemory_s) past_.pop_front();
}

routines::Pose DeadReckoning::at(double t) const {
  const auto after = std::find_if(past_.begin(), past_.end(), [t](const Past& one) { return one.t >= t; });
  if (after == past_.end()) return pose_;
  if (after == past_.begin()) return after->pose;
  const auto& [t0, from] = *std::prev(after);
  const auto& [t1, to] = *after;
  const double share = (t - t0) / (t1 - t0);
  return {std::lerp(from.x, to.x, share), std::lerp(from.y, to.y, share), std::lerp(from.yaw, to.yaw, share)};
}

double middle_of(const Scan& scan) {
  if (!scan.times.empty()) return scan.t + 0.5 * static_cast<double>(scan.times.back());
  const auto beams = static_cast<double>(scan.ranges.size());
  return scan.t + 0.5 * std::max(0.0, beams - 1.0) * scan.time_increment.value_or(0.0);
}

routines::Pose relative(const routines::Pose& start, const routines::Pose& pose) {
  const double c = std::cos(start.yaw);
  const double s = std::sin(start.yaw);
  const double dx = pose.x - start.x;
  const double dy = pose.y - start.y;
  return {c * dx + s * dy, -s * dx + c * dy, pose.yaw - start.yaw};
}

routines::Pose composed(const routines::Pose& a, const routines::Pose& b) {
  const double c = std::cos(a.yaw);
  const double s = std::sin(a.yaw);
  return {a.x + c * b.x - s * b.y, a.y + s * b.x + c * b.y, a.yaw + b.yaw};
}

}  // namespace odomcalib
