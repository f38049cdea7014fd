// The twist of one tick interval: where base parameters and effects meet.
#pragma once

#include <span>

#include "calib/math/se2.hpp"
#include "calib/vehicle/drive_model.hpp"

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

}  // namespace odomcalib::calib::vehicle
