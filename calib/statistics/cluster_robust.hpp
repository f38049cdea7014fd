// Covariance of a fit that does not trust its noise model: errors may be correlated within blocks of a
// recording (sandwich estimate; K.-Y. Liang and S. Zeger, Biometrika 73, 1986).
#pragma once

#include <Eigen/Core>

namespace odomcalib::calib {

class ClusterRobust {
 public:
  /// @param inverse of the normal matrix: the model's covariance
  explicit ClusterRobust(Eigen::MatrixXd inverse);

  /// Takes in whitened Jacobian' times whitened residual of what was measured at `time`, s; in order of time
  /// within a recording. A block ends after 5 s.
  void add(double time, const Eigen::VectorXd& score);
  /// Blocks do not reach into the next recording.
  void end_recording();

  [[nodiscard]] Eigen::MatrixXd covariance() const;
  /// The model's covariance, each deviation raised to the robust one where that is larger, and to `variance`
  /// times the model's at least.
  [[nodiscard]] Eigen::MatrixXd inflated(double variance) const;

 private:
  Eigen::MatrixXd inverse_, scatter_;
  Eigen::VectorXd block_;
  double begin_;
  double blocks_ = 0.0;
};

}  // namespace odomcalib::calib
