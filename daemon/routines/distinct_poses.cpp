#include "daemon/routines/distinct_poses.hpp"

#include <cmath>

namespace odomcalib::routines {

void DistinctPoses::add(const Pose& pose) {
  const std::uint64_t cell = cell_of(pose);
  if (!poses_.empty() && cell == last_) return;
  last_ = cell;
  if (taken_.insert(cell).second) poses_.push_back(pose);
}

/// In one number: 24 bits for each coordinate are more than any robot drives, 16 for the heading than a turn
/// has.
std::uint64_t DistinctPoses::cell_of(const Pose& pose) const {
  const auto nearest = [](double value, double size) {
    return static_cast<std::uint64_t>(std::lround(value / size));
  };
  constexpr std::uint64_t kCoordinate = 0xFFFFFF, kHeading = 0xFFFF;
  return (nearest(pose.x, place_) & kCoordinate) << 40U | (nearest(pose.y, place_) & kCoordinate) << 16U |
         (nearest(wrapped(pose.yaw), heading_) & kHeading);
}

}  // namespace odomcalib::routines
