// For devices that take the robot's speed and turn rate instead of wheel speeds.
#pragma once

#include "proto/measurements.hpp"

namespace odomcalib::drivers {

struct Twist {
  double speed = 0.0;      ///< m/s
  double turn_rate = 0.0;  ///< rad/s, counter-clockwise positive
};

/// With the nominal geometry: the device turns it back into wheel speeds with its own.
inline Twist twist_of(const RobotDescription& robot, double left_rad_s, double right_rad_s) {
  const double left = 0.5 * robot.left_wheel_diameter * left_rad_s;
  const double right = 0.5 * robot.right_wheel_diameter * right_rad_s;
  return {0.5 * (left + right), robot.track_width > 0.0 ? (right - left) / robot.track_width : 0.0};
}

}  // namespace odomcalib::drivers
