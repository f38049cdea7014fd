// Simultaneous calibration of odometry and sensor pose in closed form.
// A. Censi, A. Franchi, L. Marchionni, G. Oriolo: Simultaneous calibration of odometry and sensor parameters
// for mobile robots, IEEE Transactions on Robotics 29(2), 2013, section V.
#pragma once

#include <Eigen/Core>
#include <span>

#include "calib/classical/closed_form_options.hpp"
#include "calib/wheels/wheel_motion.hpp"
#include "proto/result.hpp"

namespace odomcalib::calib::classical {

struct ClosedFormResult {
  wheels::BaseParameters parameters;
  /// Order: left_radius, right_radius, track_width, mount x, y, yaw. Inverse Fisher information with the
  /// noise of the final inliers (the published figures take the noise of the first round, outliers included).
  Eigen::Matrix<double, 6, 6> covariance;
  Eigen::Vector3d
      rms;  ///< prediction error of the sensor motion over the samples of the last estimate: m, m, rad
  Eigen::Vector3d first_rms;  ///< same over all samples after the first round
  std::vector<std::size_t> inliers;
};

/// Errors: empty (no samples), refused (the motion does not determine the parameters; says which motion is
/// missing).
Result<ClosedFormResult> solve_closed_form(std::span<const wheels::WheelMotion> samples,
                                           const ClosedFormOptions& options = {});

}  // namespace odomcalib::calib::classical
