// How far dead reckoning may be off: by what chance does to the wheels, and by what is not known of them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "calib/odometry/dead_reckoning.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/measurements.hpp"

namespace odomcalib::calib::odometry {

/// Standard deviations of an increment one metre long, forward and sideways in m, in heading in rad:
/// variances grow with the way that the wheels roll, so that those of a longer one grow with its root.
using IncrementNoise = std::array<double, 3>;

/// The noise as the calibration file has it.
ContactNoise entry_of(const IncrementNoise& noise);
/// Noise of wheels and floor that the drives of a calibration showed; nullopt where the file has none, or
/// none that is finite and no less than zero.
std::optional<IncrementNoise> contact_noise_of(const Calibration& calibration);

/// How far dead reckoning may be off after a path, when nothing but chance disturbs the wheels: standard
/// deviations x, y in the frame of the first pose and yaw of the last one: m, m, rad. First order in
/// the errors, increments independent of each other.
/// @param track_width m: wheels roll in turns on the spot, too
std::array<double, 3> deviation_at_end(std::span<const PoseSample> path, const IncrementNoise& noise,
                                       double track_width);

/// Covariance of a running pose, first order in all errors: increments independent of each other, the
/// parameters' errors the same all the way. Takes no memory after it was made.
class Uncertainty {
 public:
  Uncertainty(const Correction& correction, const IncrementNoise& noise);

  /// Takes in the interval that `reckoning` was advanced by last.
  /// @param before pose at its begin
  void advance(const DeadReckoning& reckoning, const vehicle::StepContext& interval,
               const math::Pose& before);
  /// The pose is certain now.
  void forget();

  /// Covariance of the pose: x, y, yaw, in the frame of its origin.
  [[nodiscard]] Eigen::Matrix3d of_pose() const;
  /// Covariance of the motion in the last interval, in the frame of the base: forward, sideways, yaw.
  [[nodiscard]] Eigen::Matrix3d of_twist() const;

 private:
  using Sensitivity = Eigen::Matrix<double, 3, Eigen::Dynamic>;
  void differentiate(const DeadReckoning& reckoning, const vehicle::StepContext& interval);
  [[nodiscard]] Eigen::Matrix3d by_parameters(const Sensitivity& sensitivity) const;

  Eigen::Vector3d per_metre_;          ///< variances
  double track_width_;                 ///< m
  std::vector<Eigen::Index> unknown_;  ///< parameters with a deviation: the columns of what follows
  Eigen::MatrixXd covariance_;         ///< of these
  std::vector<std::vector<vehicle::Jet>> seeds_;  ///< of all parameters, a set for each few of these
  Sensitivity of_twist_, of_pose_;
  Eigen::Matrix3d noise_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d last_noise_ = Eigen::Matrix3d::Zero();
};

}  // namespace odomcalib::calib::odometry
