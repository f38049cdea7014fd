// Noise of chained relative poses. Consecutive pairs share a scan: in axes fixed to the room the error of pair k is
// n[k+1] - n[k] + p[k], a moving average of order one with correlation between -1/2 and 0.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "calib/reference/sensor_pair.hpp"

namespace odomcalib::calib {

struct NoiseModel {
  double matcher_scale = 1.0;       ///< true over stated standard deviation of the matcher, at most 1
  double process_translation = 0.0; ///< m per axis and pair on top of the matcher's: wheels, floor, time stamps
  double process_rotation = 0.0;    ///< rad
  std::array<double, 3> correlation{};  ///< lag-1 correlation of x, y, yaw in room axes, in [-0.48, 0.3]
};

/// L^-1 of the covariance L L^T = S of all residuals of one chain: S = G (Toeplitz(1, correlation) per axis) G^T with G the
/// square roots of the pairs' covariances, divided by the pairs' robust weights. O(n) by the scalar Cholesky recursion.
class Whitener {
 public:
  /// @param headings of the sensor at each pair's begin, rad, in axes fixed to the room
  /// @param weights robust weight of each pair in (0, 1]
  Whitener(std::span<const SensorPair> pairs, std::span<const double> headings, const NoiseModel& noise,
           std::span<const double> weights);

  /// Rows 3k..3k+2 (x, y, yaw of pair k) become uncorrelated with unit variance.
  void apply(Eigen::MatrixXd& rows) const;

  /// The first half only: each pair scaled to unit variance in room axes, correlation between pairs untouched.
  void standardise(Eigen::MatrixXd& rows) const;

 private:
  std::vector<Eigen::Matrix3d> scale_;
  std::vector<std::array<double, 3>> link_;   ///< l_k: share of the previous whitened value
  std::vector<std::array<double, 3>> pivot_;  ///< d_k
};

}  // namespace odomcalib::calib
