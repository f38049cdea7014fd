#include "calib/vehicle/drive_history.hpp"

#include <algorithm>
#include <cmath>

#include "calib/vehicle/settings.hpp"

namespace odomcalib::calib::vehicle {

double dither_of(double tick_angle) { return settings::kDither * tick_angle; }

double DriveHistory::Wheel::advance(double delta, double dither) {
  if (direction == 0.0) {
    behind += delta;
    if (std::abs(behind) <= dither) return since;
    direction = std::copysign(1.0, behind);
    behind = 0.0;
    return since;
  }
  const double ahead = direction * delta - behind;
  behind = std::max(-ahead, 0.0);
  if (behind > dither) {
    direction = -direction;
    behind = 0.0;
    since = std::abs(delta);
    return 0.0;
  }
  const double before = since;
  since += std::max(ahead, 0.0);
  return before;
}

void DriveHistory::advance_direction(StepContext& c, const math::Pose& step) {
  const double least = std::max(settings::kStandingSpeed,
                                settings::kOnTheSpotShare * 0.5 * base_.track_width * std::abs(c.turn_rate));
  const double now = std::abs(c.speed) > least ? std::copysign(1.0, c.speed) : direction_;
  if (direction_ != 0.0 && now != direction_) since_reversal_ = 0.0;
  direction_ = now;
  c.direction = direction_;
  c.since_reversal = since_reversal_;
  c.way = std::copysign(std::hypot(step.x, step.y), step.x * direction_);
  since_reversal_ += c.way;
  c.distance = distance_;
  distance_ += c.way;
  c.left_since_reversal = left_.advance(c.left_delta, dither_);
  c.right_since_reversal = right_.advance(c.right_delta, dither_);
}

void DriveHistory::relax_tyres(StepContext& c, const math::Pose& step) {
  const double turn_rate = c.dt > 0.0 ? std::copysign(step.yaw, step.yaw * step.x) / c.dt : 0.0;
  tyres_.advance(c.way, turn_rate, c.dt > 0.0 ? turn_rate * c.way / c.dt : 0.0);
  c.relaxed_turn_rate = tyres_.turn_rate();
  c.relaxed_lateral_acceleration = tyres_.lateral_acceleration();
}

void DriveHistory::remember_stop(StepContext& c, const math::Pose& step) {
  standstill_.arrive(c.relative_speed, c.dt);
  c.since_stop = standstill_.since();
  standstill_.leave(
      0.5 * (base_.left_radius * std::abs(c.left_delta) + base_.right_radius * std::abs(c.right_delta)));
  if (!groups_.contain(CovariateGroup::winding)) return;
  const Winding::Rims rims{base_.left_radius * c.left_delta, base_.right_radius * c.right_delta,
                           std::max(std::abs(c.left_speed), std::abs(c.right_speed))};
  c.unwound = winding_.advance(standstill_, rims, step, c.dt);
  c.fastest = winding_.fastest();
}

void DriveHistory::advance_groups(StepContext& c, const math::Pose& step) {
  if (groups_.contain(CovariateGroup::gear_play))
    latest_.lost = {left_gears_.advance(c.left_delta, dither_), right_gears_.advance(c.right_delta, dither_)};
  if (groups_.contain(CovariateGroup::caster)) latest_.sines = casters_.advance(step, base_.track_width);
  c.on_demand = &latest_;
  if (groups_.contain(CovariateGroup::tyre_relaxation)) relax_tyres(c, step);
  if (groups_.contain(CovariateGroup::stops)) remember_stop(c, step);
  if (groups_.contain(CovariateGroup::previous_acceleration)) {
    c.previous_acceleration = previous_acceleration_.value();
    previous_acceleration_.advance(c.forward_acceleration, c.peak_acceleration, c.dt);
  }
  if (groups_.contain(CovariateGroup::previous_turn)) {
    c.previous_turn = previous_turn_.value();
    previous_turn_.advance(step.yaw);
  }
}

void DriveHistory::advance(StepContext& c) {
  const math::Pose step = wheels::wheel_arc(base_.left_radius * c.left_delta,
                                            base_.right_radius * c.right_delta, base_.track_width);
  advance_direction(c, step);
  advance_groups(c, step);
  c.face(pose_.yaw + step.yaw / 2.0);
  c.x = pose_.x;
  c.y = pose_.y;
  pose_ = compose(pose_, step);
}

}  // namespace odomcalib::calib::vehicle
