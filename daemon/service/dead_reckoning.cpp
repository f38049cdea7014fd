#include "daemon/service/dead_reckoning.hpp"

#include <cmath>
#include <numbers>

namespace odomcalib {

void DeadReckoning::add(const TickSample& sample, const RobotDescription& robot) {
  const bool joined = last_ && last_->segment == sample.segment;
  const bool known = robot.ticks_per_rev > 0.0 && robot.track_width > 0.0;
  if (joined && known) {
    const double per_tick = std::numbers::pi / robot.ticks_per_rev;
    const double left = static_cast<double>(sample.left - last_->left) * per_tick * robot.left_wheel_diameter;
    const double right =
        static_cast<double>(sample.right - last_->right) * per_tick * robot.right_wheel_diameter;
    const double turn = (right - left) / robot.track_width;
    const double middle = pose_.yaw + 0.5 * turn;
    pose_.x += 0.5 * (left + right) * std::cos(middle);
    pose_.y += 0.5 * (left + right) * std::sin(middle);
    pose_.yaw += turn;
  }
  last_ = sample;
}

routines::Pose relative(const routines::Pose& start, const routines::Pose& pose) {
  const double c = std::cos(start.yaw);
  const double s = std::sin(start.yaw);
  const double dx = pose.x - start.x;
  const double dy = pose.y - start.y;
  return {c * dx + s * dy, -s * dx + c * dy, pose.yaw - start.yaw};
}

}  // namespace odomcalib
