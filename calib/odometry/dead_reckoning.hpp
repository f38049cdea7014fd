// Dead reckoning, interval by interval: what predict, the daemon and the library have in common.
#pragma once

#include "calib/odometry/correction.hpp"
#include "calib/vehicle/motion_step.hpp"
#include "calib/vehicle/placed_effects.hpp"
#include "calib/vehicle/pose_sum.hpp"
#include "calib/wheels/wheel_motion.hpp"

namespace odomcalib::calib::odometry {

/// Begins at the origin. Takes no memory after it was made.
class DeadReckoning {
 public:
  explicit DeadReckoning(Correction correction);

  /// @param interval as the effects look at it
  void advance(const vehicle::StepContext& interval);
  /// The pose before the last interval, as if that had not been.
  void take_back();

  [[nodiscard]] const math::Pose& pose() const { return sum_.pose(); }
  /// Motion in the last interval (x, y, yaw of the group's logarithm): m, m, rad.
  [[nodiscard]] const math::Pose& twist() const { return twist_; }
  [[nodiscard]] const Correction& correction() const { return correction_; }
  [[nodiscard]] const vehicle::PlacedEffects& effects() const { return effects_; }
  [[nodiscard]] wheels::BaseParameters base() const {
    return vehicle::to_base(vehicle::as_span(correction_.parameters));
  }
  /// Whether it looks at nothing of an interval but how far the wheels turned in it.
  [[nodiscard]] bool is_plain() const { return correction_.effects.empty(); }

 private:
  Correction correction_;
  vehicle::PlacedEffects effects_;
  vehicle::PoseSum sum_, before_;
  math::Pose twist_;
};

}  // namespace odomcalib::calib::odometry
