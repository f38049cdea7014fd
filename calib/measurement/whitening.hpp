// Noise of chained relative poses. Consecutive pairs share a scan: in axes fixed to the room the error of
// pair k is n[k+1] - n[k] + p[k], so that neighbours are correlated by up to -1/2. A scan whose stamp is off
// by dt looks displaced by its velocity times dt, and that error too enters two pairs with opposite signs.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "calib/measurement/sensor_pair.hpp"

namespace odomcalib::calib::measurement {

struct NoiseModel {
  double matcher_scale = 1.0;        ///< true over stated standard deviation of the matcher
  double process_translation = 0.0;  ///< m per axis and pair on top of the matcher's: wheels, floor
  double process_rotation = 0.0;     ///< rad
  double stamp_jitter = 0.0;         ///< s, standard deviation of a scan's time stamp against the ticks'
  std::array<double, 3>
      correlation{};  ///< lag-1 correlation of x, y, yaw without the jitter, in [-0.48, 0.3]
};

/// State that the noise of a pair depends on besides its covariance.
struct PairState {
  double heading = 0.0;  ///< of the sensor at the begin, rad, in axes fixed to the room
  Eigen::Vector3d begin_velocity = Eigen::Vector3d::Zero();  ///< of the sensor in room axes: m/s, m/s, rad/s
  Eigen::Vector3d end_velocity = Eigen::Vector3d::Zero();
};

/// Covariance of one pair in room axes: without the jitter, with it added to that, and with it.
Eigen::Matrix3d base_covariance(const SensorPair& pair, const PairState& state, const NoiseModel& noise);
Eigen::Matrix3d with_jitter(const Eigen::Matrix3d& base, const PairState& state, const NoiseModel& noise);
Eigen::Matrix3d full_covariance(const SensorPair& pair, const PairState& state, const NoiseModel& noise);

/// Covariance of a pair's error (rows) with that of the pair before it, in room axes; zero unless they share
/// a scan.
Eigen::Matrix3d neighbour_covariance(const SensorPair& previous, const PairState& previous_state,
                                     const SensorPair& pair, const PairState& state, const NoiseModel& noise);

/// Residual of a pair turned into room axes.
Eigen::Vector3d to_room(const Eigen::Vector3d& residual, const PairState& state);

/// L^-1 of the block-tridiagonal covariance L L^T of all residuals of one chain, in O(n).
class Whitener {
 public:
  /// @param weights robust weight of each pair; a pair's residual is scaled by its root
  Whitener(std::span<const SensorPair> pairs, std::span<const PairState> states, const NoiseModel& noise,
           std::span<const double> weights);

  /// Rows 3k..3k+2 (x, y, yaw of pair k in the sensor's frame) become uncorrelated with unit variance.
  void apply(Eigen::Ref<Eigen::MatrixXd> rows) const;

 private:
  std::vector<Eigen::Matrix3d> turn_;     ///< to room axes, times the root of the weight
  std::vector<Eigen::Matrix3d> inverse_;  ///< inverse of the diagonal blocks of L
  std::vector<Eigen::Matrix3d> link_;     ///< blocks of L left of the diagonal; zero where a chain begins
};

}  // namespace odomcalib::calib::measurement
