#include "daemon/service/motion_count.hpp"

#include <fmt/format.h>

#include <cmath>

#include "calib/classical/settings.hpp"
#include "calib/measurement/settings.hpp"
#include "daemon/service/dead_reckoning.hpp"
#include "proto/angles.hpp"

namespace odomcalib {
namespace {

void count(MotionCount::Kind& kind, double amount) {
  ++kind.stretches;
  kind.amount += amount;
}

}  // namespace

void MotionCount::add(const TickSample& sample, const RobotDescription& robot) {
  using calib::measurement::settings::kPairDistance_m;
  using calib::measurement::settings::kPairRotation_rad;
  if (const auto step = last_ ? increment_between(*last_, sample, robot) : std::nullopt) {
    distance_ += std::abs(step->forward);
    turn_ += step->turn;
    if (distance_ >= kPairDistance_m || std::abs(turn_) >= kPairRotation_rad) end_stretch();
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
