// Dependence of an interval on the drive before it.
#pragma once

#include "calib/math/se2.hpp"
#include "calib/vehicle/covariates.hpp"
#include "calib/vehicle/motion_step.hpp"
#include "calib/vehicle/settings.hpp"
#include "calib/wheels/wheel_motion.hpp"

namespace odomcalib::calib::vehicle {

/// Motion of a wheel that is a count to and fro, rad.
double dither_of(double tick_angle);

/// State accumulated over a drive: pose by the plain model, how far back the last reversals lie, and the
/// requested groups of covariates. Contexts refer to it for those on demand.
class DriveHistory {
 public:
  /// @param tick_angle rad, of one count: a wheel that stands between two may show either
  DriveHistory(const wheels::BaseParameters& base, double tick_angle,
               CovariateGroups groups = kAllCovariateGroups)
      : base_(base), dither_(dither_of(tick_angle)), groups_(groups) {}
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
  void advance_direction(StepContext& context, const math::Pose& step);
  void advance_groups(StepContext& context, const math::Pose& step);
  void relax_tyres(StepContext& context, const math::Pose& step);
  void remember_stop(StepContext& context, const math::Pose& step);

  wheels::BaseParameters base_;
  double dither_;  ///< rad
  CovariateGroups groups_;
  math::Pose pose_;
  Wheel left_, right_;
  double direction_ = 0.0;
  double since_reversal_ = settings::kBeforeTheDrive;
  double distance_ = 0.0;

  /// Values of the interval that was taken in last.
  struct Latest final : OnDemand {
    LostByWheels lost;
    CasterSines sines{};
    [[nodiscard]] const LostByWheels& lost_to_play(std::size_t /*interval*/) const override { return lost; }
    [[nodiscard]] const CasterSines& caster(std::size_t /*interval*/) const override { return sines; }
  } latest_;
  GearPlay left_gears_, right_gears_;
  Standstill standstill_;
  Winding winding_;
  TyreRelaxation tyres_;
  PreviousTurn previous_turn_;
  PreviousAcceleration previous_acceleration_;
  CasterSwing casters_;
};

}  // namespace odomcalib::calib::vehicle
