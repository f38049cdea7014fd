// The recordings of one robot made ready for fitting: wheel tracks, models, nominal parameters, measured
// pairs.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "calib/measurement/fit_data.hpp"
#include "calib/measurement/pair_builder.hpp"
#include "calib/wheels/wheel_motion.hpp"
#include "proto/recording/recording.hpp"
#include "proto/result.hpp"

namespace odomcalib::calib::measurement {

class Session {
 public:
  /// Errors: those of check_recordings; format also when robots differ.
  static Result<Session> open(std::span<const Recording> recordings);

  [[nodiscard]] std::span<const Recording> recordings() const { return recordings_; }
  [[nodiscard]] const wheels::BaseParameters& nominal() const { return nominal_; }
  /// True when a pose of the base itself is the reference, so that there is no sensor pose to estimate.
  [[nodiscard]] bool reference_is_base() const { return reference_is_base_; }
  /// True when scans are the reference.
  [[nodiscard]] bool reference_is_scans() const;
  /// The poses of the reference are those of a marker beside the middle of the axle, or look elsewhere: where
  /// it sits is to be fitted, as for a lidar.
  void let_reference_sit_anywhere(bool anywhere) { reference_sits_anywhere_ = anywhere; }
  [[nodiscard]] bool reference_sits_anywhere() const { return reference_sits_anywhere_; }
  /// Which of the base parameters stay at their nominal value.
  [[nodiscard]] std::vector<bool> fixed(std::size_t effect_parameters) const;

  /// Measures the pairs of all recordings anew with these parameters as guess and for de-skewing.
  void measure(const Eigen::VectorXd& parameters, const vehicle::EffectList& effects,
               const PairOptions& options);

  /// Other measurements of the pairs of one recording.
  void set_pairs(std::size_t recording, std::vector<SensorPair> pairs) {
    data_[recording].pairs = std::move(pairs);
  }
  /// Where the scans of one recording were taken.
  void set_places(std::size_t recording, std::vector<PlacedScan> places) {
    data_[recording].places = std::move(places);
  }

  /// Tells the models where the base was (see DriveModel::locate).
  /// @param fixes per recording
  void locate(std::span<const std::vector<vehicle::Fix>> fixes, const Eigen::VectorXd& parameters,
              const vehicle::EffectList& effects);

  [[nodiscard]] const std::vector<FitData>& data() const { return data_; }
  [[nodiscard]] const std::vector<PairSet>& pair_sets() const { return sets_; }
  [[nodiscard]] std::size_t pair_count() const;

 private:
  std::span<const Recording> recordings_;
  wheels::BaseParameters nominal_;
  bool reference_is_base_ = false;
  bool reference_sits_anywhere_ = false;
  std::deque<vehicle::DriveModel> models_;  ///< addresses stay valid: FitData points here
  std::vector<FitData> data_;
  std::vector<PairSet> sets_;
};

/// Wheel rotation and sensor motion of each pair, for the estimators that need no model of time.
/// @param delay of the sensor against the encoders, s
std::vector<wheels::WheelMotion> wheel_motions(std::span<const FitData> data, double delay);

}  // namespace odomcalib::calib::measurement
