// The direct linear method: scan increment = X * odometry increment with a free 3x3 matrix.
#pragma once

#include <Eigen/Core>
#include <span>

#include "calib/math/se2.hpp"
#include "proto/result.hpp"

namespace odomcalib::calib::classical {

/// Two increments over the same interval, both in the frame of its start.
struct IncrementPair {
  math::Pose odometry;
  math::Pose observed;
};

struct LinearResult {
  Eigen::Matrix3d matrix;
  double condition = 0.0;      ///< of A^T A, the 9x9 normal matrix
  Eigen::Vector3d rms;         ///< of observed - X * odometry: m, m, rad
  double orthogonality = 0.0;  ///< max |A^T (b - A x)| / (|A| |b|); zero for an exact least-squares solution
  std::size_t used = 0;
};

/// Least squares by QR. Errors: refused when fewer than three independent increments exist; names the
/// odometry components that never occurred.
Result<LinearResult> solve_linear(std::span<const IncrementPair> samples);

/// Wheel radii and track width that X implies (only x11, x31, x33 are well determined on a differential
/// drive): r = r0 x11, b = b0 x11 / x33, r_right - r_left = x31 r0 b.
struct LinearReading {
  double left_radius = 0.0, right_radius = 0.0, track_width = 0.0;
};
LinearReading read_linear(const Eigen::Matrix3d& matrix, double nominal_radius, double nominal_track_width);

}  // namespace odomcalib::calib::classical
