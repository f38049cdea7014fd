#include "daemon/safety/envelope.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "daemon/safety/settings.hpp"
#include "proto/angles.hpp"

namespace odomcalib::safety {
namespace {}  // namespace

Envelope Envelope::of(const routines::Preview& preview) {
  return {std::max(settings::kLeastReach_m, settings::kReachAllowed * preview.reach),
          std::max(settings::kLeastTurn_rad, settings::kTurnAllowed * preview.heading),
          settings::kTimeAllowed * preview.duration};
}

std::optional<std::string> Envelope::violated(const routines::Pose& from_start, double turned,
                                              double elapsed) const {
  const double distance = std::hypot(from_start.x, from_start.y);
  if (!(distance <= reach)) return fmt::format("{:.2f} m from the start, {:.2f} m allowed", distance, reach);
  if (!(std::abs(turned) <= turn))
    return fmt::format("turned {:.0f} deg, {:.0f} deg allowed", turned * kDegrees, turn * kDegrees);
  if (!(elapsed <= time)) return fmt::format("{:.0f} s in motion, {:.0f} s allowed", elapsed, time);
  return std::nullopt;
}

std::optional<std::string> disagreement(const routines::Pose& odometry, const routines::Pose& lidar) {
  const double moved = std::hypot(odometry.x, odometry.y);
  const double seen = std::hypot(lidar.x, lidar.y);
  const double longest = std::max(moved, seen);
  const double apart = std::hypot(odometry.x - lidar.x, odometry.y - lidar.y);
  const double of_mount = settings::kMountError_m * 2.0 * std::abs(std::sin(0.5 * odometry.yaw));
  if (longest > settings::kJudgedDistance_m &&
      apart > settings::kTolerance * longest + settings::kMatchDistance_m + of_mount)
    return fmt::format("odometry says {:.3f} m, the lidar {:.3f} m, {:.3f} m apart", moved, seen, apart);
  const double turned = std::abs(routines::wrapped(odometry.yaw));
  const double turn_apart = std::abs(routines::wrapped(odometry.yaw - lidar.yaw));
  const double largest = std::max(turned, std::abs(routines::wrapped(lidar.yaw)));
  if (largest > settings::kJudgedTurn_rad &&
      turn_apart > settings::kTolerance * largest + settings::kMatchTurn_rad)
    return fmt::format("odometry and lidar differ by {:.1f} deg after {:.0f} deg", turn_apart * kDegrees,
                       largest * kDegrees);
  return std::nullopt;
}

}  // namespace odomcalib::safety
