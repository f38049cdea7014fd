// Motion within a tick interval.
#pragma once

#include <span>

#include "calib/math/se2.hpp"
#include "calib/wheels/wheel_track.hpp"

namespace odomcalib::calib::vehicle {

/// The twist of a share s of an interval, linear in the twists of three intervals (WheelTrack::bend).
class PartOfStep {
 public:
  /// @param twists of all intervals of the track
  PartOfStep(const wheels::WheelTrack& track, std::span<const math::Pose> twists, std::size_t step)
      : bend_(track.bend(step)), own_(twists[step]) {
    if (step > 0) before_ = twists[step - 1];
    if (step + 1 < twists.size()) after_ = twists[step + 1];
  }

  /// What the twists before, of, and after the interval are multiplied by.
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
