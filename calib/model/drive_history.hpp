// What an interval owes to the drive before it.
#pragma once

#include <array>

#include "calib/estimators/wheel_motion.hpp"
#include "calib/geometry/se2.hpp"
#include "calib/model/motion_step.hpp"

namespace odomcalib::calib {

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
  double distance_ = 0.0;
  double pace_ = 0.0;
  double stood_ = 0.0;  ///< s
  std::array<double, kStops.size()> since_stop_;
  std::array<double, kRelaxations.size()> relaxed_turn_rate_{}, relaxed_lateral_acceleration_{};
  Memory previous_turn_{};
  PushMemory previous_push_{};
  std::array<double, kCasters> caster_{};  ///< rad, direction in which each would roll, base axes
};

}  // namespace odomcalib::calib
