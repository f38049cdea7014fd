#include "calib/classical/linear.hpp"

#include <Eigen/Dense>
#include <string>

namespace odomcalib::calib::classical {
namespace {

/// Below this share of the largest column norm a column of A counts as never excited.
constexpr double kColumnTolerance = 1e-9;

Eigen::MatrixX3d rows_of(std::span<const IncrementPair> samples, math::Pose IncrementPair::*member) {
  Eigen::MatrixX3d rows(static_cast<Eigen::Index>(samples.size()), 3);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const math::Pose& p = samples[i].*member;
    rows.row(static_cast<Eigen::Index>(i)) << p.x, p.y, p.yaw;
  }
  return rows;
}

Error underdetermined(const Eigen::MatrixX3d& odometry) {
  static constexpr const char* kNames[] = {"forward motion", "sideways motion (turn while driving)",
                                           "rotation"};
  std::string missing;
  const double largest = odometry.colwise().norm().maxCoeff();
  for (int k = 0; k < 3; ++k)
    if (!(odometry.col(k).norm() > kColumnTolerance * largest))
      missing += std::string(missing.empty() ? "" : ", ") + kNames[k];
  return {ErrorCode::refused,
          "underdetermined: the increments span fewer than three directions" +
              (missing.empty() ? std::string() : " (missing: " + missing + ")"),
          "linear method", "record straight lines, arcs and turns on the spot"};
}

}  // namespace

// The three rows of X are independent problems with one design matrix: A = kron(U, I3) up to a row
// permutation, so cond(A^T A) = cond(U^T U) and one QR of the n x 3 matrix U serves all.
Result<LinearResult> solve_linear(std::span<const IncrementPair> samples) {
  const Eigen::MatrixX3d odometry = rows_of(samples, &IncrementPair::odometry);
  const Eigen::MatrixX3d observed = rows_of(samples, &IncrementPair::observed);
  if (!odometry.allFinite() || !observed.allFinite())
    return Error{ErrorCode::refused, "an increment is not finite", "linear method", "check the recording"};
  if (samples.size() < 3) return underdetermined(odometry);
  const Eigen::JacobiSVD<Eigen::MatrixX3d> svd(odometry);
  const double ratio = svd.singularValues()(2) / svd.singularValues()(0);
  if (!(ratio > kColumnTolerance)) return underdetermined(odometry);
  const Eigen::HouseholderQR<Eigen::MatrixX3d> qr(odometry);
  LinearResult result;
  const Eigen::Matrix3d transposed = qr.solve(observed);
  result.matrix = transposed.transpose();
  const Eigen::MatrixX3d residual = observed - odometry * transposed;
  result.condition = 1.0 / (ratio * ratio);
  result.rms =
      (residual.colwise().squaredNorm() / static_cast<double>(samples.size())).cwiseSqrt().transpose();
  const double scale = odometry.norm() * observed.norm();
  result.orthogonality = scale > 0.0 ? (odometry.transpose() * residual).cwiseAbs().maxCoeff() / scale : 0.0;
  result.used = samples.size();
  return result;
}

LinearReading read_linear(const Eigen::Matrix3d& matrix, double nominal_radius, double nominal_track_width) {
  LinearReading reading;
  const double radius = nominal_radius * matrix(0, 0);
  reading.track_width = nominal_track_width * matrix(0, 0) / matrix(2, 2);
  const double difference = matrix(2, 0) * nominal_radius * reading.track_width;
  reading.left_radius = radius - difference / 2.0;
  reading.right_radius = radius + difference / 2.0;
  return reading;
}

}  // namespace odomcalib::calib::classical
