#include "calib/measurement/whitening.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "calib/math/vector2.hpp"

namespace odomcalib::calib::measurement {
namespace {

/// Symmetric square root: neighbouring pairs keep the same axes, so that their errors line up.
Eigen::Matrix3d symmetric_root(const Eigen::Matrix3d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance);
  const Eigen::Vector3d values = eigen.eigenvalues().cwiseMax(1e-18);
  return eigen.eigenvectors() * values.cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
}

/// Covariance without the jitter.
/// @param turn to room axes
Eigen::Matrix3d in_room(const SensorPair& pair, const Eigen::Matrix3d& turn, const NoiseModel& noise) {
  Eigen::Matrix3d covariance =
      noise.matcher_scale * noise.matcher_scale * (turn * pair.covariance * turn.transpose());
  const double translation = noise.process_translation * noise.process_translation;
  covariance(0, 0) += translation;
  covariance(1, 1) += translation;
  covariance(2, 2) += noise.process_rotation * noise.process_rotation;
  return covariance;
}

Eigen::Matrix3d jitter_covariance(const Eigen::Vector3d& velocity, const NoiseModel& noise) {
  return noise.stamp_jitter * noise.stamp_jitter * velocity * velocity.transpose();
}

/// @param root, previous_root symmetric roots of the base covariances of a pair and of the one before it
Eigen::Matrix3d shared_covariance(const Eigen::Matrix3d& root, const Eigen::Matrix3d& previous_root,
                                  const PairState& state, const NoiseModel& noise) {
  const Eigen::Vector3d correlation(noise.correlation[0], noise.correlation[1], noise.correlation[2]);
  return root * correlation.asDiagonal() * previous_root.transpose() -
         jitter_covariance(state.begin_velocity, noise);
}

}  // namespace

Eigen::Matrix3d base_covariance(const SensorPair& pair, const PairState& state, const NoiseModel& noise) {
  return in_room(pair, math::rotation_about_z(state.heading), noise);
}

Eigen::Matrix3d with_jitter(const Eigen::Matrix3d& base, const PairState& state, const NoiseModel& noise) {
  return base + jitter_covariance(state.begin_velocity, noise) + jitter_covariance(state.end_velocity, noise);
}

Eigen::Matrix3d full_covariance(const SensorPair& pair, const PairState& state, const NoiseModel& noise) {
  return with_jitter(base_covariance(pair, state, noise), state, noise);
}

Eigen::Matrix3d neighbour_covariance(const SensorPair& previous, const PairState& previous_state,
                                     const SensorPair& pair, const PairState& state,
                                     const NoiseModel& noise) {
  if (!pair.follows_previous) return Eigen::Matrix3d::Zero();
  return shared_covariance(symmetric_root(base_covariance(pair, state, noise)),
                           symmetric_root(base_covariance(previous, previous_state, noise)), state, noise);
}

Eigen::Vector3d to_room(const Eigen::Vector3d& residual, const PairState& state) {
  return math::rotation_about_z(state.heading) * residual;
}

Whitener::Whitener(std::span<const SensorPair> pairs, std::span<const PairState> states,
                   const NoiseModel& noise, std::span<const double> weights) {
  turn_.reserve(pairs.size());
  inverse_.reserve(pairs.size());
  link_.reserve(pairs.size());
  Eigen::Matrix3d previous_root = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Eigen::Matrix3d turn = math::rotation_about_z(states[k].heading);
    turn_.push_back(std::sqrt(weights[k]) * turn);
    const Eigen::Matrix3d base = in_room(pairs[k], turn, noise);
    const Eigen::Matrix3d root = symmetric_root(base);
    Eigen::Matrix3d diagonal = with_jitter(base, states[k], noise);
    Eigen::Matrix3d link = Eigen::Matrix3d::Zero();
    if (k > 0 && pairs[k].follows_previous) {
      link = shared_covariance(root, previous_root, states[k], noise) * inverse_.back().transpose();
      diagonal -= link * link.transpose();
    }
    const Eigen::Matrix3d lower = diagonal.llt().matrixL();
    inverse_.push_back(lower.triangularView<Eigen::Lower>().solve(Eigen::Matrix3d::Identity()));
    link_.push_back(link);
    previous_root = root;
  }
}

void Whitener::apply(Eigen::Ref<Eigen::MatrixXd> rows) const {
  Eigen::Matrix3Xd block(3, rows.cols());
  for (std::size_t k = 0; k < turn_.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(3 * k);
    block.noalias() = turn_[k] * rows.middleRows<3>(row);
    if (k > 0) block.noalias() -= link_[k] * rows.middleRows<3>(row - 3);
    rows.middleRows<3>(row).noalias() = inverse_[k] * block;
  }
}

}  // namespace odomcalib::calib::measurement
