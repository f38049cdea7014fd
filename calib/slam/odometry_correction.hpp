// Constant errors of odometry, learnt on the way from steps that scans measured: wheels of other sizes than
// stated bend and stretch every step alike, and a sensor that is not where it was said to be adds a share of
// each turn. Where scans cannot measure a step, odometry so corrected stands in.
#pragma once

#include <Eigen/Core>

#include "calib/math/se2.hpp"

namespace odomcalib::calib::slam {

/// Step measured = step by odometry + B (step by odometry), B a 3 x 3 matrix about zero: the linear method of
/// estimators/linear.hpp, recursive and with a prior.
class OdometryCorrection {
 public:
  /// @param sigma m and rad, of a step by odometry before anything is learnt; never stated larger afterwards
  explicit OdometryCorrection(double sigma);

  /// A step as odometry has it, and as scans measured it.
  void learn(const math::Pose& odometry, const math::Pose& measured);
  [[nodiscard]] math::Pose corrected(const math::Pose& odometry) const;
  /// Standard deviation of a corrected step: m, m, rad.
  [[nodiscard]] const Eigen::Vector3d& sigma() const { return sigma_; }

 private:
  double first_sigma_;
  Eigen::Matrix3d information_, products_;  ///< of the steps, in units of the error's variance
  Eigen::Matrix3d systematic_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d sigma_, squares_;
  double count_;
};

}  // namespace odomcalib::calib::slam
