// What an interval owes to the drive before it.
#pragma once

#include <array>

#include "calib/math/se2.hpp"
#include "calib/vehicle/motion_step.hpp"
#include "calib/vehicle/settings.hpp"
#include "calib/wheels/wheel_motion.hpp"

namespace odomcalib::calib::vehicle {

/// What accumulates over a drive: pose by the plain model, and how far back the last reversals lie.
class DriveHistory {
 public:
  /// @param tick_angle rad, of one count: a wheel that stands between two may show either
  DriveHistory(const wheels::BaseParameters& base, double tick_angle)
      : base_(base), dither_(settings::kDither * tick_angle) {
    since_stop_.fill(settings::kBeforeTheDrive);
  }
  /// Fills the fields of `context` that depend on the drive so far, then takes the interval in.
  void advance(StepContext& context);

 private:
  struct Wheel {
    double direction = 0.0;
    double behind = 0.0;  ///< rad, its farthest point in that direction; without one, its way so far
    double since = settings::kBeforeTheDrive;
    /// @return rotation since the last reversal before this interval, rad
    double advance(double delta, double dither);
  };
  /// A motor that turns to and fro within the play of its gears, for each of kPlays.
  struct Gears {
    bool has_moved = false;
    std::array<double, kPlays.size()> gap{};  ///< rad, from the flank that drives backwards
    /// @return rotation of this interval that does not reach the wheel, rad
    LostToPlay advance(double delta, double dither);
  };
  void swing_caster(StepContext& context, const math::Pose& step);
  void relax_turn(StepContext& context, const math::Pose& step);
  void remember_stop(StepContext& context);
  void wind_up(const StepContext& context, const math::Pose& step);
  void unwind(StepContext& context);
  void remember_acceleration(StepContext& context);
  void remember_turn(StepContext& context, double yaw);

  wheels::BaseParameters base_;
  double dither_;  ///< rad
  math::Pose pose_;
  Wheel left_, right_;
  Gears left_gears_, right_gears_;
  double direction_ = 0.0;
  double since_reversal_ = settings::kBeforeTheDrive;
  double distance_ = 0.0;
  double relative_speed_ = 0.0;
  double stood_ = 0.0;  ///< s
  std::array<Unwound, kWindings> wound_{};
  double fastest_ = 0.0;  ///< m/s
  std::array<double, kStops.size()> since_stop_;
  std::array<double, kRelaxations.size()> relaxed_turn_rate_{}, relaxed_lateral_acceleration_{};
  Memory previous_turn_{};
  AccelerationMemory previous_acceleration_{};
  std::array<double, kCasters> caster_{};  ///< rad, direction in which each would roll, base axes
};

}  // namespace odomcalib::calib::vehicle
