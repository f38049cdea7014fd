// Covariance of a fit that does not trust its noise model: errors may be correlated within blocks of a
// recording (sandwich estimate; K.-Y. Liang and S. Zeger, Biometrika 73, 1986).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace odomcalib::calib::math {

class ClusterRobust {
 public:
  /// @param inverse of the normal matrix: the model's covariance
  explicit ClusterRobust(Eigen::MatrixXd inverse);

  /// Takes in whitened Jacobian' times whitened residual of what was measured at `time`, s; in order of time
  /// within a recording. A block ends after 5 s.
  void add(double time, const Eigen::VectorXd& score);
  /// Blocks do not reach into the next recording.
  void end_recording();

  /// The model's covariance, each deviation raised to the robust one where that is larger, and to the root of
  /// `variance` times the model's at least. Errors that drift for longer than a block are found by joining
  /// neighbouring blocks: a parameter takes the scatter of longer ones where it exceeds that of the short
  /// ones by more than chance allows.
  [[nodiscard]] Eigen::MatrixXd inflated(double variance) const;

 private:
  struct Scatter {
    Eigen::VectorXd variances;  ///< of the parameters
    double blocks = 0.0;
  };
  /// With so many neighbouring blocks taken as one.
  [[nodiscard]] Scatter scatter(std::size_t joined) const;
  [[nodiscard]] Eigen::VectorXd variances() const;

  Eigen::MatrixXd inverse_;
  std::vector<std::vector<Eigen::VectorXd>> recordings_;  ///< scores of their blocks
  double begin_;                                          ///< s, of the last block
};

}  // namespace odomcalib::calib::math
