// Error of a scan match, and how it compares with the covariance of the match.
#pragma once

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "calib/match.hpp"

namespace odomcalib::test_support {

/// @param motion true x, y (m) and yaw (rad)
inline Eigen::Vector3d error_of(const calib::ScanMatch& match, const Eigen::Vector3d& motion) {
  return {match.pose[0] - motion(0), match.pose[1] - motion(1),
          std::remainder(match.pose[2] - motion(2), 2.0 * std::numbers::pi)};
}

/// e' C^-1 e; three are expected.
inline double normalised_squared(const calib::ScanMatch& match, const Eigen::Vector3d& error) {
  Eigen::Matrix3d covariance;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = match.covariance[i][j];
  return error.dot(covariance.inverse() * error);
}

}  // namespace odomcalib::test_support
