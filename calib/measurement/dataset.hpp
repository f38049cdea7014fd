// The recordings of one robot made ready for fitting, as a value: wheel tracks, models, nominal parameters,
// measured pairs. Copies share what is large; what differs is made beside the old and leaves it as it is.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "calib/ingest/recordings.hpp"
#include "calib/measurement/pair_builder.hpp"
#include "calib/measurement/sensor_pair.hpp"
#include "calib/wheels/wheel_motion.hpp"
#include "proto/result.hpp"

namespace odomcalib::calib::measurement {

struct Dataset {
  ingest::Recordings recordings;
  wheels::BaseParameters nominal;
  std::vector<std::shared_ptr<const vehicle::DriveModel>> models;  ///< one per recording
  /// The poses of the reference are those of a marker beside the middle of the axle, or look elsewhere: where
  /// it sits is to be fitted, as for a lidar.
  bool reference_sits_anywhere = false;

  // Measured data; empty before.
  std::vector<FitData> data;       ///< one per recording; points to the models
  std::vector<PairSet> pair_sets;  ///< one per recording
  /// Parameters that the pairs were measured with, those of the base and of the effects; empty when they were
  /// measured roughly.
  Eigen::VectorXd measured_with;

  /// Motions are stated one by one, without times.
  [[nodiscard]] bool has_motions_alone() const { return !recordings.front().increments.empty(); }
  /// A pose of the base itself is the reference, so that there is no sensor pose to estimate.
  [[nodiscard]] bool reference_is_base() const;
  [[nodiscard]] bool reference_is_scans() const;
  /// Flags of the base parameters that stay at their nominal value.
  [[nodiscard]] std::vector<bool> fixed() const;
  /// With parameters so near, matches begin at the same guess and scans are de-skewed alike.
  [[nodiscard]] bool is_measured_with(const Eigen::VectorXd& parameters) const;
};

/// Nothing is measured yet. Errors: those of check_recordings.
Result<Dataset> open_dataset(const ingest::Recordings& recordings);

/// The same drives, to be measured by other scans.
/// @param repaired the dataset's recordings with other scans, everything else alike
Dataset with_scans_of(Dataset dataset, const ingest::Recordings& repaired);

/// The pairs of all recordings for a first look, with nominal values.
Dataset measured_roughly(Dataset dataset);

/// The pairs of all recordings with these parameters as guess and for de-skewing.
Dataset measured(Dataset dataset, const Eigen::VectorXd& parameters, const vehicle::EffectList& effects);

/// The models know where the base was (see DriveModel::located).
/// @param fixes per recording
Dataset located(Dataset dataset, std::span<const std::vector<vehicle::Fix>> fixes,
                const Eigen::VectorXd& parameters, const vehicle::EffectList& effects);

/// Wheel rotation and sensor motion of each pair, for the estimators that need no model of time.
/// @param delay of the sensor against the encoders, s
std::vector<wheels::WheelMotion> wheel_motions(std::span<const FitData> data, double delay);

/// The same of those pairs alone that leave no direction open, for estimators that take all they get for
/// measured.
std::vector<wheels::WheelMotion> whole_wheel_motions(std::span<const FitData> data, double delay);

}  // namespace odomcalib::calib::measurement
