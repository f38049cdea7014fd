// The direct linear method: scan increment = X * odometry increment with a free 3x3 matrix.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/math/se2.hpp"
#include "proto/result.hpp"

namespace odomcalib::calib::classical {

/// Two increments over the same interval, both in the frame of its start.
struct IncrementPair {
  math::Pose odometry;
  math::Pose observed;
};

/// Ways to the same answer. LDLT and the normal equations lose twice the digits and are left for QR where
/// these are too few.
enum class LinearSolver { qr, svd, ldlt, normal_equations };
const char* name_of(LinearSolver solver);

struct LinearResult {
  Eigen::Matrix3d matrix;
  LinearSolver solver = LinearSolver::qr;  ///< that was used
  double condition = 0.0;                  ///< of A^T A, the 9x9 normal matrix
  Eigen::Vector3d rms;                     ///< of observed - X * odometry: m, m, rad
  double orthogonality = 0.0;  ///< max |A^T (b - A x)| / (|A| |b|); zero for an exact least-squares solution
  std::size_t used = 0;
};

/// Least squares. Errors: refused when fewer than three independent increments exist; names the odometry
/// components that never occurred.
Result<LinearResult> solve_linear(std::span<const IncrementPair> samples,
                                  LinearSolver solver = LinearSolver::qr);

/// A^T A and A^T b, pair after pair: the answer from a stream of which nothing is kept.
class LinearSums {
 public:
  /// Why the pair was not taken; nullopt when it was.
  std::optional<std::string> add(const IncrementPair& sample);
  [[nodiscard]] std::size_t count() const { return count_; }
  /// Errors: those of solve_linear.
  [[nodiscard]] Result<LinearResult> solve() const;

 private:
  Eigen::Matrix3d odometry_ = Eigen::Matrix3d::Zero();  ///< sum of u u^T
  Eigen::Matrix3d mixed_ = Eigen::Matrix3d::Zero();     ///< sum of u v^T
  Eigen::Vector3d observed_ = Eigen::Vector3d::Zero();  ///< sum of the squares of v
  std::size_t count_ = 0;
};

/// X u: the increment of odometry as the matrix corrects it.
math::Pose corrected(const Eigen::Matrix3d& matrix, const math::Pose& odometry);

/// Poses after each increment, from the origin: each increment is in the frame of its start, so that it is
/// turned by the heading before it, not after it.
std::vector<math::Pose> path_of(std::span<const math::Pose> increments);

/// Wheel radii and track width that X implies (only x11, x31, x33 are well determined on a differential
/// drive): r = r0 x11, b = b0 x11 / x33, r_right - r_left = x31 r0 b.
struct LinearReading {
  double left_radius = 0.0, right_radius = 0.0, track_width = 0.0;
};
LinearReading read_linear(const Eigen::Matrix3d& matrix, double nominal_radius, double nominal_track_width);

}  // namespace odomcalib::calib::classical
