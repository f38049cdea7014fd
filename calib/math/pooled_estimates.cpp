#include "calib/math/pooled_estimates.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>

#include "calib/math/linear_solve.hpp"

namespace odomcalib::calib::math {
namespace {

/// The square of a normal distance that is as unlikely as this one with an estimated covariance (H.
/// Hotelling, Ann. Math. Statist. 2, 1931).
double as_chi_squared(double square, double size, double freedom) {
  namespace bm = boost::math;
  const double spare = freedom - size + 1.0;
  if (!(spare > 0.0) || !(square > 0.0)) return 0.0;
  const double chance = bm::cdf(bm::complement(bm::fisher_f(size, spare), square * spare / (freedom * size)));
  return chance > 0.0 ? bm::quantile(bm::complement(bm::chi_squared(size), chance)) : square;
}

/// Units of the parameters differ by orders of magnitude.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXd scale = matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols());
  return scale.asDiagonal() * math::solve_symmetric(scaled, identity) * scale.asDiagonal();
}

}  // namespace

Pool::Pool(Eigen::Index size)
    : information_(Eigen::MatrixXd::Zero(size, size)), weighted_(Eigen::VectorXd::Zero(size)) {}

void Pool::add(const Eigen::VectorXd& value, const Eigen::MatrixXd& covariance) {
  const Eigen::MatrixXd weight = inverse_of(covariance);
  information_ += weight;
  weighted_ += weight * value;
}

Eigen::MatrixXd Pool::covariance() const { return inverse_of(information_); }

double cochran(const std::vector<OwnValues>& estimates) {
  Pool pool(estimates.front().value.size());
  for (const OwnValues& one : estimates) pool.add(one.value, one.covariance);
  const Eigen::VectorXd mean = pool.value();
  double sum = 0.0;
  for (const OwnValues& one : estimates) {
    const Eigen::VectorXd apart = one.value - mean;
    sum += as_chi_squared(apart.dot(inverse_of(one.covariance) * apart), static_cast<double>(apart.size()),
                          one.freedom);
  }
  return sum;
}

double variance_between(const std::vector<OwnValues>& estimates, Eigen::Index parameter) {
  double weights = 0.0, squares = 0.0, weighted = 0.0;
  for (const OwnValues& one : estimates) {
    const double w = 1.0 / one.covariance(parameter, parameter);
    weights += w;
    squares += w * w;
    weighted += w * one.value(parameter);
  }
  const double mean = weighted / weights;
  double q = 0.0;
  for (const OwnValues& one : estimates)
    q += (one.value(parameter) - mean) * (one.value(parameter) - mean) / one.covariance(parameter, parameter);
  const double spare = weights - squares / weights;
  return spare > 0.0 ? std::max(0.0, (q - static_cast<double>(estimates.size() - 1)) / spare) : 0.0;
}

}  // namespace odomcalib::calib::math
