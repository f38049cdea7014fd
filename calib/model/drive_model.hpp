// From wheel angles to the sensor's motion: the model that every estimator and every effect shares.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "calib/estimators/wheel_motion.hpp"
#include "calib/model/effect.hpp"
#include "calib/model/motion_step.hpp"
#include "calib/wheels/wheel_track.hpp"

namespace odomcalib::calib {

using EffectList = std::vector<std::shared_ptr<const Effect>>;

/// Order of the parameter vector: the base parameters, then those of each effect.
enum BaseIndex { kLeftRadius, kRightRadius, kTrackWidth, kMountX, kMountY, kMountYaw, kBaseCount };
Eigen::VectorXd to_vector(const BaseParameters& base, std::size_t effect_parameters = 0);
BaseParameters to_base(std::span<const double> parameters);
std::size_t count_parameters(const EffectList& effects);

/// Begin and end of a measured motion, s on the sensor's clock.
struct Interval {
  double begin = 0.0;
  double end = 0.0;
};

/// Base poses at the samples of a track and the constant twist in between.
class Trajectory {
 public:
  /// Base pose at each sample, starting at the origin.
  [[nodiscard]] const std::vector<Pose>& poses() const { return poses_; }
  /// Base pose at the encoder time that belongs to a time on the sensor's clock.
  [[nodiscard]] Pose at(double sensor_time) const;

 private:
  friend class DriveModel;
  const WheelTrack* track_ = nullptr;  ///< outlives the trajectory: both belong to the model
  std::vector<Pose> poses_;
  std::vector<Pose> twists_;
  std::vector<double> parameters_;
  EffectList effects_;
};

class DriveModel {
 public:
  /// @param context one per interval between samples of the track (see make_context)
  DriveModel(WheelTrack track, std::vector<StepContext> context);

  [[nodiscard]] const WheelTrack& track() const { return track_; }
  [[nodiscard]] const std::vector<StepContext>& context() const { return context_; }

  /// Dead reckoning with these parameters, to be asked for poses.
  [[nodiscard]] Trajectory trajectory(std::span<const double> parameters, const EffectList& effects) const;

  /// Motion of the sensor in each interval, in its frame at the interval's begin.
  [[nodiscard]] std::vector<Pose> predict(std::span<const double> parameters, const EffectList& effects,
                                          std::span<const Interval> intervals) const;

  /// As predict(); `jacobian` becomes 3 n x parameters (rows x, y, yaw per interval).
  std::vector<Pose> predict(std::span<const double> parameters, const EffectList& effects,
                            std::span<const Interval> intervals, Eigen::MatrixXd& jacobian) const;

 private:
  WheelTrack track_;
  std::vector<StepContext> context_;
};

/// Observable variables of each tick interval, from smoothed wheel angles and nominal geometry.
std::vector<StepContext> make_context(const WheelTrack& track, const BaseParameters& nominal);

}  // namespace odomcalib::calib
