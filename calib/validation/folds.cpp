#include "calib/validation/folds.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <functional>

#include "calib/math/linear_solve.hpp"
#include "calib/validation/settings.hpp"

namespace odomcalib::calib::validation {

std::vector<std::size_t> folds_of(std::span<const measurement::FitData> data) {
  std::vector<std::size_t> folds;
  std::size_t block = 0;
  for (const measurement::FitData& d : data) {
    double begin = -1e300;
    for (const measurement::SensorPair& pair : d.pairs) {
      if (pair.interval.begin > begin + settings::kFoldBlock_s) {
        begin = pair.interval.begin;
        ++block;
      }
      folds.push_back(block % kFolds);
    }
  }
  return folds;
}

bool hold_out(const std::vector<std::size_t>& folds) {
  return std::adjacent_find(folds.begin(), folds.end(), std::not_equal_to<>()) != folds.end();
}

Eigen::VectorXd without_fold(const estimation::FitResult& fit, const std::vector<std::size_t>& folds,
                             std::size_t fold, const std::vector<bool>& fixed) {
  const Eigen::Index p = fit.parameters.size();
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(p, p);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(p);
  for (std::size_t k = 0; k < folds.size(); ++k) {
    if (folds[k] == fold) continue;
    const auto rows = fit.whitened_jacobian.middleRows<3>(static_cast<Eigen::Index>(3 * k));
    normal.noalias() += rows.transpose() * rows;
    gradient.noalias() +=
        rows.transpose() * fit.whitened_residual.segment<3>(static_cast<Eigen::Index>(3 * k));
  }
  normal += fit.prior_information;
  gradient -= fit.prior_information * fit.parameters;
  for (Eigen::Index k = 0; k < p; ++k) {
    if (!fixed[static_cast<std::size_t>(k)]) continue;
    normal.row(k).setZero();
    normal.col(k).setZero();
    normal(k, k) = 1.0;
    gradient(k) = 0.0;
  }
  const Eigen::VectorXd scale = normal.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
  const Eigen::VectorXd right_side = scale.asDiagonal() * gradient;
  return fit.parameters + scale.asDiagonal() * math::solve_symmetric(scaled, right_side);
}

}  // namespace odomcalib::calib::validation
