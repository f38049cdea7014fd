#include "calib/statistics/cluster_robust.hpp"

#include <algorithm>
#include <cmath>

namespace odomcalib::calib {
namespace {

constexpr double kBlockSeconds = 5.0;
constexpr double kNever = -1e300;

}  // namespace

ClusterRobust::ClusterRobust(Eigen::MatrixXd inverse)
    : inverse_(std::move(inverse)),
      scatter_(Eigen::MatrixXd::Zero(inverse_.rows(), inverse_.cols())),
      block_(Eigen::VectorXd::Zero(inverse_.rows())),
      begin_(kNever) {}

void ClusterRobust::add(double time, const Eigen::VectorXd& score) {
  if (time > begin_ + kBlockSeconds) {
    end_recording();
    begin_ = time;
  }
  block_ += score;
}

void ClusterRobust::end_recording() {
  if (!block_.isZero()) blocks_ += 1.0;
  scatter_ += block_ * block_.transpose();
  block_.setZero();
  begin_ = kNever;
}

Eigen::MatrixXd ClusterRobust::covariance() const {
  const double small_sample = blocks_ > 1.0 ? blocks_ / (blocks_ - 1.0) : 1.0;
  return small_sample * inverse_ * scatter_ * inverse_;
}

Eigen::MatrixXd ClusterRobust::inflated(double variance) const {
  const Eigen::MatrixXd robust = covariance();
  Eigen::VectorXd inflation = Eigen::VectorXd::Ones(inverse_.rows());
  for (Eigen::Index k = 0; k < inverse_.rows(); ++k)
    if (inverse_(k, k) > 0.0) inflation(k) = std::sqrt(std::max(variance, robust(k, k) / inverse_(k, k)));
  return inflation.asDiagonal() * inverse_ * inflation.asDiagonal();
}

}  // namespace odomcalib::calib
