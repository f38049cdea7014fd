// Decompositions of Eigen for the types that calib uses most, compiled once: each of them costs a compiler as
// much as the rest of a source. Others are asked of Eigen where they are needed.
#pragma once

#include <Eigen/Core>

namespace odomcalib::calib::math {

/// Solution x of a x = b for a symmetric, positive semi-definite matrix, by LDL^T with pivoting.
Eigen::Vector2d solve_symmetric(const Eigen::Matrix2d& a, const Eigen::Vector2d& b);
Eigen::Vector3d solve_symmetric(const Eigen::Matrix3d& a, const Eigen::Vector3d& b);
Eigen::Matrix3d solve_symmetric(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// Inverse of a symmetric, positive definite matrix, by LDL^T.
Eigen::Matrix3d inverse_symmetric(const Eigen::Matrix3d& a);

/// Eigenvalues in ascending order and their vectors as columns.
struct Eigensystem {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
/// Eigensystem of a symmetric matrix.
Eigensystem eigensystem(const Eigen::MatrixXd& symmetric);

/// In descending order.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& a);

/// Least squares: x that makes |a x - b| least, by the singular values of a.
Eigen::MatrixXd solve_least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// The same for columns that are independent, by QR with pivoting of columns.
Eigen::MatrixXd solve_independent(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// x of unit length that makes |a x| least, by the singular values of a.
Eigen::VectorXd null_vector(const Eigen::MatrixXd& a);

/// Orthonormal basis of the columns: directions of less than this length are left out.
Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& columns, double least);

}  // namespace odomcalib::calib::math
