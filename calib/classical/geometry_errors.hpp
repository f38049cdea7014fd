// The three systematic errors of a differential drive as factors (J. Borenstein, L. Feng: Measurement and
// correction of systematic odometry errors in mobile robots, IEEE Transactions on Robotics and Automation
// 12(6), 1996).
#pragma once

#include "calib/wheels/wheel_motion.hpp"

namespace odomcalib::calib::classical {

struct GeometryErrors {
  double scale = 1.0;      ///< E_s: mean wheel diameter, true over nominal
  double diameters = 1.0;  ///< E_d: true right diameter over true left diameter
  double track = 1.0;      ///< E_b: track width, true over nominal
};

inline GeometryErrors errors_of(const wheels::BaseParameters& truth, const wheels::BaseParameters& nominal) {
  return {(truth.left_radius + truth.right_radius) / (nominal.left_radius + nominal.right_radius),
          truth.right_radius / truth.left_radius, truth.track_width / nominal.track_width};
}

/// Inverse of errors_of; the sensor's pose is that of `nominal`.
inline wheels::BaseParameters with_errors(const wheels::BaseParameters& nominal,
                                          const GeometryErrors& errors) {
  const double sum = errors.scale * (nominal.left_radius + nominal.right_radius);
  wheels::BaseParameters truth = nominal;
  truth.left_radius = sum / (1.0 + errors.diameters);
  truth.right_radius = errors.diameters * truth.left_radius;
  truth.track_width = errors.track * nominal.track_width;
  return truth;
}

}  // namespace odomcalib::calib::classical
