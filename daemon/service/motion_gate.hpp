// Conditions that must hold before the robot may move.
#pragma once

#include <optional>

#include "daemon/service/parts/robot_parts.hpp"

namespace odomcalib {

/// Error usage: nobody watches a robot for so long.
std::optional<Error> too_long(const routines::Plan& plan);

/// Why the robot must not drive this now: interrupted write-back, controller, its watchdog, stale sensors,
/// values that were not read, something on the way. The dimensions themselves are judged when they were read
/// again: Drive::geometry_forbidden.
std::optional<Error> motion_forbidden(const RobotParts& parts, const routines::Preview& preview);

}  // namespace odomcalib
