#include "calib/math/linear_solve.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace odomcalib::calib::math::linear_solve_test {
namespace {

constexpr double kRounding = 1e-12;

/// Numbers without a pattern, the same each time.
Eigen::MatrixXd numbers(Eigen::Index rows, Eigen::Index columns) {
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [](Eigen::Index i, Eigen::Index k) {
    return std::sin(1.0 + 3.7 * static_cast<double>(i) + 1.3 * static_cast<double>(i * k + k * k));
  });
}

Eigen::MatrixXd square_of(const Eigen::MatrixXd& a) { return a.transpose() * a; }

TEST(LinearSolve, symmetric_gives_back_what_it_was_made_of) {
  const Eigen::MatrixXd a = square_of(numbers(7, 3)), x = numbers(3, 3);
  const Eigen::Matrix3d fixed = a;
  EXPECT_LT((solve_symmetric(a, Eigen::MatrixXd(a * x)) - x).norm(), kRounding);
  EXPECT_LT((solve_symmetric(fixed, Eigen::Matrix3d(a * x)) - x).norm(), kRounding);
  EXPECT_LT((inverse_symmetric(fixed) * fixed - Eigen::Matrix3d::Identity()).norm(), kRounding);
}

TEST(LinearSolve, of_an_eigensystem_makes_the_matrix_again_in_ascending_order) {
  const Eigen::MatrixXd a = square_of(numbers(7, 4));
  const Eigensystem eigen = eigensystem(a);
  EXPECT_LT((eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose() - a).norm(), kRounding);
  for (Eigen::Index k = 1; k < eigen.values.size(); ++k) EXPECT_LE(eigen.values(k - 1), eigen.values(k));
}

TEST(LinearSolve, singular_values_are_the_roots_of_the_eigenvalues_of_the_square) {
  const Eigen::MatrixXd a = numbers(7, 3);
  const Eigen::VectorXd roots = eigensystem(square_of(a)).values.cwiseSqrt().reverse();
  EXPECT_LT((singular_values(a) - roots).norm(), kRounding);
}

TEST(LinearSolve, least_squares_leave_nothing_along_the_columns) {
  const Eigen::MatrixXd a = numbers(9, 3), b = numbers(9, 2);
  for (const Eigen::MatrixXd& x : {solve_least_squares(a, b), solve_independent(a, b)})
    EXPECT_LT((a.transpose() * (b - a * x)).norm(), kRounding);
}

TEST(LinearSolve, a_null_vector_has_unit_length_and_is_what_the_matrix_makes_shortest) {
  Eigen::MatrixXd a = numbers(5, 5);
  a.col(4) = 2.0 * a.col(0) - a.col(2);
  const Eigen::VectorXd x = null_vector(a);
  EXPECT_NEAR(x.norm(), 1.0, kRounding);
  EXPECT_LT((a * x).norm(), kRounding);
  const Eigen::MatrixXd regular = numbers(4, 4);
  EXPECT_NEAR((regular * null_vector(regular)).norm(), singular_values(regular)(3), kRounding);
}

TEST(LinearSolve, a_basis_spans_its_columns_and_leaves_out_short_directions) {
  Eigen::MatrixXd a = numbers(6, 3);
  a.col(2) = a.col(0) + 1e-9 * a.col(1);
  const Eigen::MatrixXd basis = orthonormal_basis(a, 1e-6);
  ASSERT_EQ(basis.cols(), 2);
  EXPECT_LT((square_of(basis) - Eigen::Matrix2d::Identity()).norm(), kRounding);
  EXPECT_LT((a - basis * (basis.transpose() * a)).norm(), 1e-8);
}

}  // namespace
}  // namespace odomcalib::calib::math::linear_solve_test
