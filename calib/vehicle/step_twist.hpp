// The twist of one tick interval, where base parameters and effects meet, and motion within it.
#pragma once

#include <span>

#include "calib/math/se2.hpp"
#include "calib/vehicle/drive_model.hpp"
#include "calib/wheels/wheel_track.hpp"

namespace odomcalib::calib::vehicle {

/// Constant motion in the interval (x, y, yaw of the group's logarithm).
/// @param parameters base parameters, then those of each effect
template <typename T>
math::Pose2<T> twist_of(const StepContext& context, std::span<const T> parameters,
                        const PlacedEffects& effects) {
  WheelStep<T> step;
  step.left = parameters[kLeftRadius] * context.left_delta;
  step.right = parameters[kRightRadius] * context.right_delta;
  effects.apply(context, parameters, step);
  return {(step.left + step.right) / 2.0, step.side,
          (step.right - step.left) / (parameters[kTrackWidth] * step.track) + step.yaw};
}

/// Delays that change with time are counted from here, so that they do not look like a constant one.
inline double middle_of(const wheels::WheelTrack& track) { return (track.t.front() + track.t.back()) / 2.0; }

/// The twist of a share s of an interval, linear in the twists of three intervals (WheelTrack::bend).
class PartOfStep {
 public:
  /// @param twists of all intervals of the track
  PartOfStep(const wheels::WheelTrack& track, std::span<const math::Pose> twists, std::size_t step)
      : bend_(track.bend(step)), own_(twists[step]) {
    if (step > 0) before_ = twists[step - 1];
    if (step + 1 < twists.size()) after_ = twists[step + 1];
  }

  /// Factors of the twists before, of, and after the interval.
  template <typename T>
  struct Weights {
    T before, own, after;
  };
  template <typename T>
  [[nodiscard]] Weights<T> weights(const T& share) const {
    const T bow = 0.5 * share * (share - 1.0);
    return {-bend_.before * bow, share, bend_.after * bow};
  }

  template <typename T>
  [[nodiscard]] math::Pose2<T> twist(const T& share) const {
    const Weights<T> by = weights(share);
    return {by.before * before_.x + by.own * own_.x + by.after * after_.x,
            by.before * before_.y + by.own * own_.y + by.after * after_.y,
            by.before * before_.yaw + by.own * own_.yaw + by.after * after_.yaw};
  }

 private:
  wheels::Bend bend_;
  math::Pose before_, own_, after_;
};

}  // namespace odomcalib::calib::vehicle
