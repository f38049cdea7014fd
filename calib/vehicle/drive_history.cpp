#include "calib/vehicle/drive_history.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "calib/vehicle/settings.hpp"

namespace odomcalib::calib::vehicle {
namespace {

/// Of a time in which a quantity goes from one value to another.
double share_below_one(double from, double to) {
  if ((from < 1.0) == (to < 1.0)) return from < 1.0 ? 1.0 : 0.0;
  return (1.0 - std::min(from, to)) / std::abs(to - from);
}

/// Means of a motion's sign move on by the motion, in units of the usual span.
void remember(std::span<double> memory, double motion) {
  for (std::size_t k = 0; k < kMemorySpans.size(); ++k)
    memory[k] -= std::expm1(-std::abs(motion) / kMemorySpans[k]) * (std::copysign(1.0, motion) - memory[k]);
}

}  // namespace

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

/// The play operator (Krasnosel'skii and Pokrovskii, Systems with Hysteresis, 1989, section 2). What a
/// standing wheel shows of two counts is no motion, so a play of less loses its share of what is one. The
/// drive begins with the flanks that its first motion needs.
LostToPlay DriveHistory::Gears::advance(double delta, double dither) {
  LostToPlay lost{};
  if (delta == 0.0) return lost;
  for (std::size_t k = 0; k < kPlays.size(); ++k) {
    const double play = std::max(kPlays[k], dither);
    if (!has_moved) gap[k] = delta > 0.0 ? play : 0.0;
    const double moved = gap[k] + delta;
    const double pushed = moved > play ? moved - play : std::min(moved, 0.0);
    gap[k] = moved - pushed;
    lost[k] = (delta - pushed) * kPlays[k] / play;
  }
  has_moved = true;
  return lost;
}

void DriveHistory::advance(StepContext& c) {
  const math::Pose step = wheels::wheel_arc(base_.left_radius * c.left_delta,
                                            base_.right_radius * c.right_delta, base_.track_width);
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
  c.left_lost = left_gears_.advance(c.left_delta, dither_);
  c.right_lost = right_gears_.advance(c.right_delta, dither_);
  swing_caster(c, step);
  relax_turn(c, step);
  remember_stop(c);
  wind_up(c, step);
  unwind(c);
  remember_acceleration(c);
  remember_turn(c, step.yaw);
  c.face(pose_.yaw + step.yaw / 2.0);
  c.x = pose_.x;
  c.y = pose_.y;
  pose_ = compose(pose_, step);
}

/// A wheel that trails by t turns towards the way s of its pivot: tan(beta / 2) falls as exp(-s / t), beta
/// the angle between both (Campion, Bastin and D'Andrea-Novel 1996, eq. 4: no slip across the wheel). A lean
/// turns it on by lean * s / t.
void DriveHistory::swing_caster(StepContext& c, const math::Pose& step) {
  const double across = -settings::kCasterBehind * base_.track_width * step.yaw;
  const double way = std::hypot(step.x, across);
  const double towards = std::atan2(across, step.x);
  std::size_t k = 0;
  for (const double trail : kCasterTrails) {
    if (!(way > 0.0)) break;
    const double turns = way / trail, fading = std::exp(-turns);
    for (const double lean : kCasterLeans) {
      const double before = math::wrap_angle(caster_[k] - towards);
      const double after = 2.0 * std::atan(std::tan(before / 2.0) * fading) + lean * turns;
      c.caster[k] = 0.5 * (std::sin(before) + std::sin(after));
      caster_[k++] = towards + after;
    }
  }
  for (double& direction : caster_) direction -= step.yaw;
}

void DriveHistory::relax_turn(StepContext& c, const math::Pose& step) {
  const double turn_rate = c.dt > 0.0 ? std::copysign(step.yaw, step.yaw * step.x) / c.dt : 0.0;
  const double lateral_acceleration = c.dt > 0.0 ? turn_rate * c.way / c.dt : 0.0;
  for (std::size_t k = 0; k < kRelaxations.size(); ++k) {
    const double share = -std::expm1(-c.way / kRelaxations[k]);
    relaxed_turn_rate_[k] += share * (turn_rate - relaxed_turn_rate_[k]);
    relaxed_lateral_acceleration_[k] += share * (lateral_acceleration - relaxed_lateral_acceleration_[k]);
  }
  c.relaxed_turn_rate = relaxed_turn_rate_;
  c.relaxed_lateral_acceleration = relaxed_lateral_acceleration_;
}

void DriveHistory::remember_stop(StepContext& c) {
  if (relative_speed_ >= 1.0) {
    if (stood_ > 0.0) fastest_ = 0.0;
    stood_ = 0.0;
  }
  stood_ += c.dt * share_below_one(relative_speed_, c.relative_speed);
  relative_speed_ = c.relative_speed;
  for (std::size_t k = 0; k < kStops.size(); ++k)
    if (stood_ > kStops[k]) since_stop_[k] = 0.0;
  c.since_stop = since_stop_;
  for (double& since : since_stop_)
    since +=
        0.5 * (base_.left_radius * std::abs(c.left_delta) + base_.right_radius * std::abs(c.right_delta));
}

/// Tyres, belts and gears; the state follows the motion over a distance of its own.
void DriveHistory::wind_up(const StepContext& c, const math::Pose& step) {
  const double left = base_.left_radius * c.left_delta, right = base_.right_radius * c.right_delta;
  const double rims = std::abs(left) + std::abs(right);
  const auto follow = [](double& state, double aim, double motion) {
    state -= std::expm1(-motion) * (aim - state);
  };
  if (stood_ > 0.0 || !(rims > 0.0)) return;
  auto& [brief, lasting] = wound_;
  follow(brief.way, (left + right) / rims, 0.5 * rims / settings::kWindWay_m);
  follow(brief.turn, (right - left) / rims, 0.5 * rims / settings::kWindWay_m);
  follow(lasting.way, std::copysign(1.0, step.x), std::abs(step.x) / settings::kWindWay_m);
  follow(lasting.turn, std::copysign(1.0, step.yaw), std::abs(step.yaw) / settings::kWindTurn_rad);
}

void DriveHistory::unwind(StepContext& c) {
  const double rim_speed = std::max(std::abs(c.left_speed), std::abs(c.right_speed));
  if (stood_ == 0.0) fastest_ = std::max(fastest_, rim_speed);
  c.fastest = fastest_;
  const double share = -std::expm1(-std::min(stood_, c.dt) / settings::kUnwind_s);
  for (std::size_t k = 0; k < kWindings; ++k) {
    c.unwound[k] = {share * wound_[k].way, share * wound_[k].turn};
    wound_[k].way -= c.unwound[k].way;
    wound_[k].turn -= c.unwound[k].turn;
  }
}

/// Noise of the acceleration at steady speed must not wash the memory out.
void DriveHistory::remember_acceleration(StepContext& c) {
  c.previous_acceleration = previous_acceleration_;
  if (std::abs(c.forward_acceleration) > kAccelerationThresholds.front())
    remember(previous_acceleration_, c.forward_acceleration * c.dt / settings::kAccelerationMemory_m_s);
  for (std::size_t k = 0; k < kAccelerationThresholds.size(); ++k)
    if (std::abs(c.peak_acceleration) > kAccelerationThresholds[k])
      previous_acceleration_[kMemorySpans.size() + k] = std::copysign(1.0, c.peak_acceleration);
}

void DriveHistory::remember_turn(StepContext& c, double yaw) {
  c.previous_turn = previous_turn_;
  remember(previous_turn_, yaw);
}

}  // namespace odomcalib::calib::vehicle
