// The measured motion of the sensor between two instants: what the model has to explain; and
// what a fit works on.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/math/se2.hpp"
#include "calib/measurement/placed_scan.hpp"
#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::measurement {

struct SensorPair {
  vehicle::Interval interval;  ///< s on the sensor's clock
  math::Pose motion;           ///< in the sensor's frame at the begin
  Eigen::Matrix3d covariance;  ///< x, y, yaw of `motion`, as the matcher states it
  bool follows_previous =
      false;  ///< begins with the scan (or pose) the previous pair ends with: their errors are correlated
  bool is_partial = false;  ///< along one direction the scans say nothing: `motion` is the guess there, the
                            ///< deviation kOpenDirection_m
};

/// One recording: the model of its wheels and what the sensor saw.
struct FitData {
  const vehicle::DriveModel* model = nullptr;
  std::vector<SensorPair> pairs;
  std::vector<PlacedScan> places = {};  ///< of its scans in a map, in time order; empty without one
};

}  // namespace odomcalib::calib::measurement
