#include "calib/noise/whitening.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace odomcalib::calib {
namespace {

Eigen::Matrix3d rotation_about_z(double yaw) {
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  Eigen::Matrix3d r;
  r << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
  return r;
}

/// Inverse of the symmetric square root: neighbouring pairs keep the same axes, so that their errors line up.
Eigen::Matrix3d inverse_root(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
  const Eigen::Vector3d values = eigen.eigenvalues().cwiseMax(1e-18);
  return eigen.eigenvectors() * values.cwiseSqrt().cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

Whitener::Whitener(std::span<const SensorPair> pairs, std::span<const double> headings, const NoiseModel& noise,
                   std::span<const double> weights) {
  scale_.reserve(pairs.size());
  const double pt = noise.process_translation * noise.process_translation;
  const Eigen::Vector3d process(pt, pt, noise.process_rotation * noise.process_rotation);
  const double matcher = noise.matcher_scale * noise.matcher_scale;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Eigen::Matrix3d to_room = rotation_about_z(headings[k]);
    Eigen::Matrix3d covariance = matcher * (to_room * pairs[k].covariance * to_room.transpose());
    covariance.diagonal() += process;
    scale_.push_back(std::sqrt(weights[k]) * inverse_root(covariance) * to_room);
    std::array<double, 3> link{};
    std::array<double, 3> pivot{1.0, 1.0, 1.0};
    if (k > 0 && pairs[k].follows_previous) {
      for (std::size_t c = 0; c < 3; ++c) {
        link[c] = noise.correlation[c] / pivot_[k - 1][c];
        pivot[c] = std::sqrt(1.0 - link[c] * link[c]);
      }
    }
    link_.push_back(link);
    pivot_.push_back(pivot);
  }
}

void Whitener::standardise(Eigen::MatrixXd& rows) const {
  for (std::size_t k = 0; k < scale_.size(); ++k) {
    auto block = rows.middleRows<3>(static_cast<Eigen::Index>(3 * k));
    block = (scale_[k] * block).eval();
  }
}

void Whitener::apply(Eigen::MatrixXd& rows) const {
  standardise(rows);
  for (std::size_t k = 0; k < scale_.size(); ++k)
    for (std::size_t c = 0; c < 3; ++c) {
      const auto row = static_cast<Eigen::Index>(3 * k + c);
      if (link_[k][c] != 0.0) rows.row(row) -= link_[k][c] * rows.row(row - 3);
      rows.row(row) /= pivot_[k][c];
    }
}

}  // namespace odomcalib::calib
