// The measured motion of the sensor between two instants: what the model has to explain.
#pragma once

#include <Eigen/Core>

#include "calib/math/se2.hpp"
#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::measurement {

struct SensorPair {
  vehicle::Interval interval;  ///< s on the sensor's clock
  math::Pose motion;           ///< in the sensor's frame at the begin
  Eigen::Matrix3d covariance;  ///< x, y, yaw of `motion`, as the matcher states it
  bool follows_previous =
      false;  ///< begins with the scan (or pose) the previous pair ends with: their errors are correlated
};

}  // namespace odomcalib::calib::measurement
