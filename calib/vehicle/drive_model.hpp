// From wheel angles to the sensor's motion: the model that every estimator and every effect shares.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "calib/vehicle/drive_context.hpp"
#include "calib/vehicle/effect.hpp"
#include "calib/vehicle/motion_step.hpp"
#include "calib/vehicle/placed_effects.hpp"
#include "calib/wheels/wheel_motion.hpp"
#include "calib/wheels/wheel_track.hpp"

namespace odomcalib::calib::vehicle {

/// Order of the parameter vector: the base parameters, then those of each effect.
enum BaseIndex { kLeftRadius, kRightRadius, kTrackWidth, kMountX, kMountY, kMountYaw, kBaseCount };
Eigen::VectorXd to_vector(const wheels::BaseParameters& base, std::size_t effect_parameters = 0);
wheels::BaseParameters to_base(std::span<const double> parameters);
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
  math::Pose pose;
};

/// Base poses at the samples of a track and the constant twist in between.
class Trajectory {
 public:
  /// Base pose at each sample, starting at the origin.
  [[nodiscard]] const std::vector<math::Pose>& poses() const { return poses_; }
  /// Twist of each interval between samples.
  [[nodiscard]] const std::vector<math::Pose>& twists() const { return twists_; }
  /// Parameters it was made with.
  [[nodiscard]] std::span<const double> parameters() const { return parameters_; }
  [[nodiscard]] const PlacedEffects& effects() const { return effects_; }
  /// Base pose at the encoder time that belongs to a time on the sensor's clock.
  [[nodiscard]] math::Pose at(double sensor_time) const;
  [[nodiscard]] double encoder_time(double sensor_time) const;
  /// Motion of the sensor in each interval, in its frame at the interval's begin.
  [[nodiscard]] std::vector<math::Pose> sensor_motions(std::span<const Interval> intervals) const;

 private:
  friend class DriveModel;
  const wheels::WheelTrack* track_ = nullptr;  ///< outlives the trajectory: both belong to the model
  std::vector<math::Pose> poses_;
  std::vector<math::Pose> twists_;
  std::vector<double> parameters_;
  PlacedEffects effects_;
};

/// Velocity of a sensor at `mount` in the axes of the trajectory, by a central difference over 40 ms: m/s,
/// m/s, rad/s. The time is the sensor's.
Eigen::Vector3d sensor_velocity(const Trajectory& trajectory, const math::Pose& mount, double time);

class DriveModel {
 public:
  /// @param context one per interval between samples of the track (see make_context)
  DriveModel(wheels::WheelTrack track, DriveContext context);

  [[nodiscard]] const wheels::WheelTrack& track() const { return track_; }
  [[nodiscard]] const std::vector<StepContext>& context() const { return context_.intervals(); }
  /// Until they are asked for again, covariates on demand take no memory.
  void forget_on_demand() const { context_.forget_on_demand(); }
  /// Contexts of the tick intervals that a measured motion touches: one at least.
  [[nodiscard]] std::span<const StepContext> context_within(const Interval& interval) const;

  /// Wheels with every interval observed with these base parameters. Heading and place are the latest fix (in
  /// time order) and dead reckoning from there on; without fixes dead reckoning alone.
  [[nodiscard]] static DriveModel located(wheels::WheelTrack track, std::span<const Fix> fixes,
                                          std::span<const double> parameters, const EffectList& effects);

  /// Dead reckoning with these parameters, from which poses are read. Throws std::invalid_argument if they
  /// are too few.
  [[nodiscard]] Trajectory trajectory(std::span<const double> parameters, const EffectList& effects) const;

  /// Trajectory::sensor_motions() with these parameters.
  [[nodiscard]] std::vector<math::Pose> predict(std::span<const double> parameters, const EffectList& effects,
                                                std::span<const Interval> intervals) const;

 private:
  wheels::WheelTrack track_;
  DriveContext context_;
};

}  // namespace odomcalib::calib::vehicle
