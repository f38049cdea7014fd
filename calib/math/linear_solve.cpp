#include "calib/math/linear_solve.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace odomcalib::calib::math {

Eigen::Vector2d solve_symmetric(const Eigen::Matrix2d& a, const Eigen::Vector2d& b) {
  return a.ldlt().solve(b);
}

Eigen::Vector3d solve_symmetric(const Eigen::Matrix3d& a, const Eigen::Vector3d& b) {
  return a.ldlt().solve(b);
}

Eigen::Matrix3d solve_symmetric(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return a.ldlt().solve(b);
}

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  return a.ldlt().solve(b);
}

Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.ldlt().solve(b);
}

Eigen::Matrix3d inverse_symmetric(const Eigen::Matrix3d& a) {
  return solve_symmetric(a, Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
}

Eigensystem eigensystem(const Eigen::MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(symmetric);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::VectorXd singular_values(const Eigen::MatrixXd& a) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(a).singularValues();
}

Eigen::MatrixXd solve_least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(a, Eigen::ComputeThinU | Eigen::ComputeThinV).solve(b);
}

Eigen::MatrixXd solve_independent(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(a).solve(b);
}

Eigen::VectorXd null_vector(const Eigen::MatrixXd& a) {
  return Eigen::JacobiSVD<Eigen::MatrixXd>(a, Eigen::ComputeFullV).matrixV().rightCols(1);
}

Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& columns, double least) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  Eigen::Index rank = 0;
  const auto& r = qr.matrixR();
  while (rank < columns.cols() && std::abs(r(rank, rank)) > least) ++rank;
  if (rank == 0) return {columns.rows(), 0};
  return qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), rank);
}

}  // namespace odomcalib::calib::math
