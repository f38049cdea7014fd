#include "calib/classical/linear.hpp"

#include <Eigen/Dense>
#include <string>

#include "calib/classical/settings.hpp"
#include "calib/math/linear_solve.hpp"

namespace odomcalib::calib::classical {
namespace {

/// Below this share of the largest column norm a column of A counts as never excited.
constexpr double kColumnTolerance = 1e-9;
/// Smallest over largest eigenvalue of summed squares that rounding leaves meaningful.
constexpr double kLeastOfSums = 1e-13;

Eigen::MatrixX3d rows_of(std::span<const IncrementPair> samples, math::Pose IncrementPair::*member) {
  Eigen::MatrixX3d rows(static_cast<Eigen::Index>(samples.size()), 3);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const math::Pose& p = samples[i].*member;
    rows.row(static_cast<Eigen::Index>(i)) << p.x, p.y, p.yaw;
  }
  return rows;
}

Error too_few_directions(const Eigen::MatrixX3d& odometry) {
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

Eigen::Matrix3d solution(const Eigen::MatrixX3d& odometry, const Eigen::MatrixX3d& observed,
                         LinearSolver solver) {
  if (solver == LinearSolver::svd) return math::solve_least_squares(odometry, observed);
  if (solver == LinearSolver::qr) return math::solve_independent(odometry, observed);
  const Eigen::Matrix3d normal = odometry.transpose() * odometry;
  const Eigen::Matrix3d mixed = odometry.transpose() * observed;
  if (solver == LinearSolver::ldlt) return math::solve_symmetric(normal, mixed);
  return normal.inverse() * mixed;
}

}  // namespace

const char* name_of(LinearSolver solver) {
  switch (solver) {
    case LinearSolver::svd:
      return "SVD";
    case LinearSolver::ldlt:
      return "LDLT";
    case LinearSolver::normal_equations:
      return "normal equations";
    case LinearSolver::qr:
      break;
  }
  return "QR";
}

// The three rows of X are independent problems with one design matrix: A = kron(U, I3) up to a row
// permutation, so cond(A^T A) = cond(U^T U) and one factorisation of the n x 3 matrix U serves all.
Result<LinearResult> solve_linear(std::span<const IncrementPair> samples, LinearSolver solver) {
  const Eigen::MatrixX3d odometry = rows_of(samples, &IncrementPair::odometry);
  const Eigen::MatrixX3d observed = rows_of(samples, &IncrementPair::observed);
  if (!odometry.allFinite() || !observed.allFinite())
    return Error{ErrorCode::refused, "an increment is not finite", "linear method", "check the recording"};
  if (samples.size() < 3) return too_few_directions(odometry);
  const Eigen::VectorXd singular = math::singular_values(odometry);
  const double ratio = singular(2) / singular(0);
  if (!(ratio > kColumnTolerance)) return too_few_directions(odometry);
  LinearResult result;
  result.condition = 1.0 / (ratio * ratio);
  const bool squares = solver == LinearSolver::ldlt || solver == LinearSolver::normal_equations;
  result.solver = squares && result.condition > settings::kMostConditionOfNormal ? LinearSolver::qr : solver;
  const Eigen::Matrix3d transposed = solution(odometry, observed, result.solver);
  result.matrix = transposed.transpose();
  const Eigen::MatrixX3d residual = observed - odometry * transposed;
  result.rms =
      (residual.colwise().squaredNorm() / static_cast<double>(samples.size())).cwiseSqrt().transpose();
  const double scale = odometry.norm() * observed.norm();
  result.orthogonality = scale > 0.0 ? (odometry.transpose() * residual).cwiseAbs().maxCoeff() / scale : 0.0;
  result.used = samples.size();
  return result;
}

std::optional<std::string> LinearSums::add(const IncrementPair& sample) {
  const Eigen::Vector3d u(sample.odometry.x, sample.odometry.y, sample.odometry.yaw);
  const Eigen::Vector3d v(sample.observed.x, sample.observed.y, sample.observed.yaw);
  if (!u.allFinite()) return "the odometry's increment is not finite";
  if (!v.allFinite()) return "the observed increment is not finite";
  odometry_ += u * u.transpose();
  mixed_ += u * v.transpose();
  observed_ += v.cwiseAbs2();
  ++count_;
  return std::nullopt;
}

Result<LinearResult> LinearSums::solve() const {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(odometry_);
  const double ratio = eigen.eigenvalues()(0) / eigen.eigenvalues()(2);
  if (count_ < 3 || !(ratio > kLeastOfSums)) return too_few_directions(odometry_);
  LinearResult result;
  result.solver = LinearSolver::ldlt;
  const Eigen::Matrix3d transposed = math::solve_symmetric(odometry_, mixed_);
  result.matrix = transposed.transpose();
  result.condition = 1.0 / ratio;
  // |b - A x|^2 = b^T b - x^T A^T b at the solution, which rounding may take below zero.
  const Eigen::Vector3d squares = observed_ - (transposed.transpose() * mixed_).diagonal();
  result.rms = (squares.cwiseMax(0.0) / static_cast<double>(count_)).cwiseSqrt();
  const double scale = std::sqrt(odometry_.trace() * observed_.sum());
  result.orthogonality = scale > 0.0 ? (mixed_ - odometry_ * transposed).cwiseAbs().maxCoeff() / scale : 0.0;
  result.used = count_;
  return result;
}

math::Pose corrected(const Eigen::Matrix3d& matrix, const math::Pose& odometry) {
  const Eigen::Vector3d u = matrix * Eigen::Vector3d(odometry.x, odometry.y, odometry.yaw);
  return {u.x(), u.y(), u.z()};
}

std::vector<math::Pose> path_of(std::span<const math::Pose> increments) {
  std::vector<math::Pose> path;
  path.reserve(increments.size());
  math::Pose pose;
  for (const math::Pose& increment : increments) path.push_back(pose = compose(pose, increment));
  return path;
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
