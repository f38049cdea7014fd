// From wheel angles to the sensor's motion: the model that every estimator and every effect shares.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "calib/estimators/wheel_motion.hpp"
#include "calib/model/effect.hpp"
#include "calib/model/motion_step.hpp"
#include "calib/model/placed_effects.hpp"
#include "calib/wheels/wheel_track.hpp"

namespace odomcalib::calib {

/// Order of the parameter vector: the base parameters, then those of each effect.
enum BaseIndex { kLeftRadius, kRightRadius, kTrackWidth, kMountX, kMountY, kMountYaw, kBaseCount };
Eigen::VectorXd to_vector(const BaseParameters& base, std::size_t effect_parameters = 0);
BaseParameters to_base(std::span<const double> parameters);
std::size_t count_parameters(const EffectList& effects);

/// Parameters as the model takes them.
inline std::span<const double> as_span(const Eigen::VectorXd& parameters) {
  return {parameters.data(), static_cast<std::size_t>(parameters.size())};
}

/// Begin and end of a measured motion, s on the sensor's clock.
struct Interval {
  double begin = 0.0;
  double end = 0.0;
};

/// Pose of the base at a time on the sensor's clock, s, known from something else than the wheels.
struct Fix {
  double time = 0.0;
  Pose pose;
};

/// Base poses at the samples of a track and the constant twist in between.
class Trajectory {
 public:
  /// Base pose at each sample, starting at the origin.
  [[nodiscard]] const std::vector<Pose>& poses() const { return poses_; }
  /// Of each interval between samples.
  [[nodiscard]] const std::vector<Pose>& twists() const { return twists_; }
  /// What it was made with.
  [[nodiscard]] std::span<const double> parameters() const { return parameters_; }
  [[nodiscard]] const PlacedEffects& effects() const { return effects_; }
  /// Base pose at the encoder time that belongs to a time on the sensor's clock.
  [[nodiscard]] Pose at(double sensor_time) const;
  [[nodiscard]] double encoder_time(double sensor_time) const;
  /// Motion of the sensor in each interval, in its frame at the interval's begin.
  [[nodiscard]] std::vector<Pose> sensor_motions(std::span<const Interval> intervals) const;

 private:
  friend class DriveModel;
  const WheelTrack* track_ = nullptr;  ///< outlives the trajectory: both belong to the model
  std::vector<Pose> poses_;
  std::vector<Pose> twists_;
  std::vector<double> parameters_;
  PlacedEffects effects_;
};

/// Velocity of a sensor at `mount` in the axes of the trajectory, by a central difference over 40 ms: m/s,
/// m/s, rad/s. The time is the sensor's.
Eigen::Vector3d sensor_velocity(const Trajectory& trajectory, const Pose& mount, double time);

class DriveModel {
 public:
  /// @param context one per interval between samples of the track (see make_context)
  DriveModel(WheelTrack track, std::vector<StepContext> context);

  [[nodiscard]] const WheelTrack& track() const { return track_; }
  [[nodiscard]] const std::vector<StepContext>& context() const { return context_; }
  /// Of the tick intervals that a measured motion touches: one at least.
  [[nodiscard]] std::span<const StepContext> context_within(const Interval& interval) const;

  /// Observes every interval anew with these base parameters. Heading and place are the latest fix (in time
  /// order) and dead reckoning from there on; without fixes dead reckoning alone.
  void locate(std::span<const Fix> fixes, std::span<const double> parameters, const EffectList& effects);

  /// Dead reckoning with these parameters, to be asked for poses. Throws std::invalid_argument if they are
  /// too few.
  [[nodiscard]] Trajectory trajectory(std::span<const double> parameters, const EffectList& effects) const;

  /// Trajectory::sensor_motions() with these parameters.
  [[nodiscard]] std::vector<Pose> predict(std::span<const double> parameters, const EffectList& effects,
                                          std::span<const Interval> intervals) const;

 private:
  WheelTrack track_;
  std::vector<StepContext> context_;
};

/// What accumulates over a drive: pose by the plain model, and how far back the last reversals lie.
class DriveHistory {
 public:
  explicit DriveHistory(const BaseParameters& base) : base_(base) { since_stop_.fill(kFarBack); }
  /// Fills the fields of `context` that depend on the drive so far, then takes the interval in.
  void advance(StepContext& context);

 private:
  /// m or rad: the drive begins as if the last reversal and the last stop lay so far back.
  static constexpr double kFarBack = 1e3;
  struct Wheel {
    double direction = 0.0;
    double since = kFarBack;
    double advance(double delta);
  };
  void swing_caster(StepContext& context, const Pose& step);
  void relax_turn(StepContext& context, const Pose& step);
  void remember_stop(StepContext& context);
  void remember_push(StepContext& context);
  void remember_turn(StepContext& context, double yaw);

  BaseParameters base_;
  Pose pose_;
  Wheel left_, right_;
  double direction_ = 0.0;
  double since_reversal_ = kFarBack;
  double pace_ = 0.0;
  double stood_ = 0.0;  ///< s
  std::array<double, kStops.size()> since_stop_;
  std::array<double, kRelaxations.size()> relaxed_turn_rate_{}, relaxed_lateral_acceleration_{};
  Memory previous_turn_{};
  PushMemory previous_push_{};
  std::array<double, kCasters> caster_{};  ///< rad, direction in which each would roll, base axes
};

/// Observable variables of each tick interval, from smoothed wheel angles and a geometry that is nearly
/// right; but for what depends on the drive before.
/// @param first interval that is wanted; the first of them takes its acceleration's change from itself alone
std::vector<StepContext> make_context_of_moment(const WheelTrack& track, const BaseParameters& base,
                                                std::size_t first = 0);

/// Where the last interval of the track is the present, changes of its acceleration come from what was
/// before: half of a window about it would be missing, and their sum over a drive would grow with the noise.
void see_from_the_past(StepContext& last, const WheelTrack& track, const BaseParameters& base);

/// With what depends on the drive before.
std::vector<StepContext> make_context(const WheelTrack& track, const BaseParameters& base);

}  // namespace odomcalib::calib
