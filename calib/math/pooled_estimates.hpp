// The same parameters estimated from several recordings: pooled, tested for homogeneity, and what lies
// between them beyond their own errors.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace odomcalib::calib::math {

/// Several estimates as one, weighted by their inverse covariances.
class Pool {
 public:
  /// @param size number of parameters
  explicit Pool(Eigen::Index size);
  void add(const Eigen::VectorXd& value, const Eigen::MatrixXd& covariance);
  [[nodiscard]] Eigen::VectorXd value() const { return covariance() * weighted_; }
  [[nodiscard]] Eigen::MatrixXd covariance() const;

 private:
  Eigen::MatrixXd information_;
  Eigen::VectorXd weighted_;
};

/// Estimates from one recording alone.
struct OwnValues {
  std::size_t recording;
  Eigen::VectorXd value;
  Eigen::MatrixXd covariance;
  double freedom = 0.0;
};

/// Cochran's Q of several parameters at once, chi-squared with as many degrees of freedom as there are
/// parameters, times the estimates less one, if all are estimates of the same (W. G. Cochran, Biometrics 10,
/// 1954).
double cochran(const std::vector<OwnValues>& estimates);

/// Variance of one parameter, beyond what the recordings' own deviations make (R. DerSimonian and N. Laird,
/// Controlled Clinical Trials 7, 1986); 0 where chance explains the differences.
double variance_between(const std::vector<OwnValues>& estimates, Eigen::Index parameter);

}  // namespace odomcalib::calib::math
