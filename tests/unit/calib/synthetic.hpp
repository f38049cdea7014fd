// Noise-free wheel motions with a known answer, made from the differential-drive equations alone.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "calib/wheels/wheel_motion.hpp"

namespace odomcalib::test_support {

/// Sensor motion for wheel rotations, written out: circle about the instantaneous centre of rotation.
inline calib::math::Pose sensor_motion_by_hand(const calib::wheels::BaseParameters& p, double left,
                                               double right) {
  const double dl = p.left_radius * left;
  const double dr = p.right_radius * right;
  const double turn = (dr - dl) / p.track_width;
  const double travel = (dl + dr) / 2.0;
  const double x = std::abs(turn) < 1e-12 ? travel : travel / turn * std::sin(turn);
  const double y = std::abs(turn) < 1e-12 ? 0.0 : travel / turn * (1.0 - std::cos(turn));
  // Position of the sensor after the motion, seen from where it was.
  const double sx = x + std::cos(turn) * p.mount.x - std::sin(turn) * p.mount.y - p.mount.x;
  const double sy = y + std::sin(turn) * p.mount.x + std::cos(turn) * p.mount.y - p.mount.y;
  const double c = std::cos(p.mount.yaw);
  const double s = std::sin(p.mount.yaw);
  return {c * sx + s * sy, -s * sx + c * sy, turn};
}

inline std::vector<calib::wheels::WheelMotion> random_motions(const calib::wheels::BaseParameters& p,
                                                              std::size_t count, unsigned seed,
                                                              double position_noise = 0.0,
                                                              double yaw_noise = 0.0) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> wheel(-1.5, 1.5);
  std::normal_distribution<double> gauss;
  std::vector<calib::wheels::WheelMotion> motions;
  for (std::size_t i = 0; i < count; ++i) {
    calib::wheels::WheelMotion m{wheel(engine), wheel(engine), {}};
    m.sensor_motion = sensor_motion_by_hand(p, m.left, m.right);
    m.sensor_motion.x += position_noise * gauss(engine);
    m.sensor_motion.y += position_noise * gauss(engine);
    m.sensor_motion.yaw += yaw_noise * gauss(engine);
    motions.push_back(m);
  }
  return motions;
}

}  // namespace odomcalib::test_support
