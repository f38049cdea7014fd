#include "daemon/service/motion_count.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "calib/classical/settings.hpp"

namespace odomcalib {
namespace {

// Where pairs of scans are cut.
constexpr double kStretch_m = 0.15;
constexpr double kStretch_rad = 0.25;

constexpr double kDegrees = 180.0 / std::numbers::pi;

void count(MotionCount::Kind& kind, double amount) {
  ++kind.stretches;
  kind.amount += amount;
}

}  // namespace

void MotionCount::add(const TickSample& sample, const RobotDescription& robot) {
  const bool joined = last_ && last_->segment == sample.segment;
  if (joined && robot.ticks_per_rev > 0.0 && robot.track_width > 0.0) {
    const double per_tick = std::numbers::pi / robot.ticks_per_rev;
    const double left = static_cast<double>(sample.left - last_->left) * per_tick * robot.left_wheel_diameter;
    const double right =
        static_cast<double>(sample.right - last_->right) * per_tick * robot.right_wheel_diameter;
    distance_ += 0.5 * std::abs(left + right);
    turn_ += (right - left) / robot.track_width;
    if (distance_ >= kStretch_m || std::abs(turn_) >= kStretch_rad) end_stretch();
  }
  last_ = sample;
}

void MotionCount::end_stretch() {
  if (std::abs(turn_) <= calib::classical::settings::kStraightYaw_rad)
    count(straight_, distance_);
  else
    count(turn_ > 0.0 ? left_ : right_, std::abs(turn_));
  distance_ = turn_ = 0.0;
}

std::vector<std::string> MotionCount::missing() const {
  using calib::classical::settings::kLeastTravel_m;
  using calib::classical::settings::kLeastTurn_rad;
  std::vector<std::string> missing;
  if (straight_.amount < kLeastTravel_m)
    missing.push_back(
        fmt::format("straight lines: {:.2f} of at least {:.2f} m", straight_.amount, kLeastTravel_m));
  if (const double turned = left_.amount + right_.amount; turned < kLeastTurn_rad)
    missing.push_back(fmt::format("turns: {:.0f} of at least {:.0f} degrees, better one turn each way",
                                  turned * kDegrees, kLeastTurn_rad * kDegrees));
  return missing;
}

}  // namespace odomcalib
