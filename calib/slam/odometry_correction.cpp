#include "calib/slam/odometry_correction.hpp"

#include <Eigen/Dense>

#include "calib/slam/settings.hpp"

namespace odomcalib::calib::slam {
namespace {

Eigen::Vector3d vector_of(const math::Pose& step) { return {step.x, step.y, math::wrap_angle(step.yaw)}; }

}  // namespace

OdometryCorrection::OdometryCorrection(double sigma)
    : first_sigma_(sigma),
      information_(Eigen::Matrix3d::Identity() * (sigma * sigma) /
                   (settings::kCorrectionPrior * settings::kCorrectionPrior)),
      products_(Eigen::Matrix3d::Zero()),
      sigma_(Eigen::Vector3d::Constant(sigma)),
      squares_(Eigen::Vector3d::Constant(settings::kPriorSteps * sigma * sigma)),
      count_(settings::kPriorSteps) {}

void OdometryCorrection::learn(const math::Pose& odometry, const math::Pose& measured) {
  const Eigen::Vector3d step = vector_of(odometry);
  Eigen::Vector3d error = vector_of(measured) - step;
  error(2) = math::wrap_angle(error(2));
  const Eigen::Vector3d rest = error - systematic_ * step;
  if ((rest.cwiseQuotient(sigma_).cwiseAbs().array() > settings::kFalseStep).any()) return;
  information_ += step * step.transpose();
  products_ += error * step.transpose();
  systematic_ = information_.ldlt().solve(products_.transpose()).transpose();
  squares_ += rest.cwiseAbs2();
  count_ += 1.0;
  sigma_ = (squares_ / count_).cwiseSqrt().cwiseMax(settings::kLeastOdometrySigma).cwiseMin(first_sigma_);
}

math::Pose OdometryCorrection::corrected(const math::Pose& odometry) const {
  const Eigen::Vector3d step = vector_of(odometry), whole = step + systematic_ * step;
  return {whole(0), whole(1), math::wrap_angle(whole(2))};
}

}  // namespace odomcalib::calib::slam
