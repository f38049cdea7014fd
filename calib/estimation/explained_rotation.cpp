#include "calib/estimation/explained_rotation.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "calib/estimation/settings.hpp"
#include "calib/math/linear_solve.hpp"

namespace odomcalib::calib::estimation {

using measurement::ReferenceMotion;
using wheels::WheelMotion;

std::vector<WheelMotion> beside_wheels(const std::vector<ReferenceMotion>& motions,
                                       const wheels::WheelTrack& track, const ClockMap& clock) {
  std::vector<WheelMotion> all;
  if (track.empty()) return all;
  for (const ReferenceMotion& m : motions) {
    const double begin = clock(m.begin), end = clock(m.end);
    if (track.covers(begin, end)) all.push_back(motion_between(track, begin, end, m.motion));
  }
  return all;
}

double explained_rotation(const std::vector<WheelMotion>& motions) {
  if (motions.size() < settings::kFewestMotions) return 0.0;
  Eigen::Vector2d gains = Eigen::Vector2d::Zero();
  double bound = 1e9, misfit = 0.0, all = 0.0;
  for (int round = 0; round < settings::kGainRounds; ++round) {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Identity() * 1e-9;
    Eigen::Vector2d right_side = Eigen::Vector2d::Zero();
    for (const WheelMotion& m : motions) {
      const Eigen::Vector2d turned(m.left, m.right);
      const double residual = std::abs(m.sensor_motion.yaw - gains.dot(turned));
      const double weight = residual > bound ? bound / residual : 1.0;
      normal += weight * turned * turned.transpose();
      right_side += weight * m.sensor_motion.yaw * turned;
    }
    gains = math::solve_symmetric(normal, right_side);
    misfit = all = 0.0;
    for (const WheelMotion& m : motions) {
      misfit += std::abs(m.sensor_motion.yaw - gains.dot(Eigen::Vector2d(m.left, m.right)));
      all += std::abs(m.sensor_motion.yaw);
    }
    bound = misfit / static_cast<double>(motions.size());
  }
  return all > 0.0 ? std::max(0.0, 1.0 - misfit / all) : 0.0;
}

bool mends(double before, double after) {
  return after > settings::kAgrees && 1.0 - after < settings::kLeftOver * (1.0 - before);
}

}  // namespace odomcalib::calib::estimation
