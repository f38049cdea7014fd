// What the robot's papers say about it.
#pragma once

#include "calib/wheels/wheel_motion.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::wheels {

/// Values that are missing stay zero.
inline BaseParameters nominal_base(const RobotDescription& robot) {
  BaseParameters base{
      robot.left_wheel_diameter / 2.0, robot.right_wheel_diameter / 2.0, robot.track_width, {}};
  if (robot.lidar_pose) base.mount = {(*robot.lidar_pose)[0], (*robot.lidar_pose)[1], (*robot.lidar_pose)[2]};
  return base;
}

}  // namespace odomcalib::calib::wheels
