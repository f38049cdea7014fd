#include "calib/vehicle/covariates.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "calib/vehicle/settings.hpp"

namespace odomcalib::calib::vehicle {
namespace {

/// Means of a motion's sign move on by the motion, in units of the usual span.
void remember(std::span<double> memory, double motion) {
  for (std::size_t k = 0; k < kMemorySpans.size(); ++k)
    memory[k] -= std::expm1(-std::abs(motion) / kMemorySpans[k]) * (std::copysign(1.0, motion) - memory[k]);
}

/// Share of the time during which a quantity that goes from one value to another is below one.
double share_below_one(double from, double to) {
  if ((from < 1.0) == (to < 1.0)) return from < 1.0 ? 1.0 : 0.0;
  return (1.0 - std::min(from, to)) / std::abs(to - from);
}

}  // namespace

void PreviousTurn::advance(double yaw) { remember(memory_, yaw); }

/// Noise of the acceleration at steady speed must not wash the memory out.
void PreviousAcceleration::advance(double acceleration, double peak, double dt) {
  if (std::abs(acceleration) > kAccelerationThresholds.front())
    remember(memory_.means, acceleration * dt / settings::kAccelerationMemory_m_s);
  for (std::size_t k = 0; k < kAccelerationThresholds.size(); ++k)
    if (std::abs(peak) > kAccelerationThresholds[k]) memory_.relays[k] = peak > 0.0 ? 1 : -1;
}

Standstill::Standstill() { since_.fill(settings::kBeforeTheDrive); }

void Standstill::arrive(double relative_speed, double dt) {
  sets_off_ = relative_speed_ >= 1.0 && stood_ > 0.0;
  if (relative_speed_ >= 1.0) stood_ = 0.0;
  stood_ += dt * share_below_one(relative_speed_, relative_speed);
  relative_speed_ = relative_speed;
  for (std::size_t k = 0; k < kStops.size(); ++k)
    if (stood_ > kStops[k]) since_[k] = 0.0;
}

void Standstill::leave(double way) {
  for (double& since : since_) since += way;
}

/// The state follows the motion over a distance of its own.
void Winding::wind_up(const Rims& rims, const math::Pose& step) {
  const auto [left, right, speed] = rims;
  const double way = std::abs(left) + std::abs(right);
  const auto follow = [](double& state, double aim, double motion) {
    state -= std::expm1(-motion) * (aim - state);
  };
  if (!(way > 0.0)) return;
  auto& [brief, lasting] = wound_;
  follow(brief.way, (left + right) / way, 0.5 * way / settings::kWindWay_m);
  follow(brief.turn, (right - left) / way, 0.5 * way / settings::kWindWay_m);
  follow(lasting.way, std::copysign(1.0, step.x), std::abs(step.x) / settings::kWindWay_m);
  follow(lasting.turn, std::copysign(1.0, step.yaw), std::abs(step.yaw) / settings::kWindTurn_rad);
}

std::array<ReleasedWinding, kWindings> Winding::unwind(double duration) {
  std::array<ReleasedWinding, kWindings> unwound{};
  const double share = -std::expm1(-duration / settings::kUnwind_s);
  for (std::size_t k = 0; k < kWindings; ++k) {
    unwound[k] = {share * wound_[k].way, share * wound_[k].turn};
    wound_[k].way -= unwound[k].way;
    wound_[k].turn -= unwound[k].turn;
  }
  return unwound;
}

std::array<ReleasedWinding, kWindings> Winding::advance(const Standstill& standstill, const Rims& rims,
                                                        const math::Pose& step, double dt) {
  const bool moves = standstill.stood() == 0.0;
  if (standstill.sets_off()) fastest_ = 0.0;
  if (moves) fastest_ = std::max(fastest_, rims.speed);
  if (moves) wind_up(rims, step);
  return unwind(std::min(standstill.stood(), dt));
}

void SwayLag::advance(Sways& before, Sways& after, double dt) {
  for (std::size_t k = 0; k < kSwayLags.size(); ++k) {
    if (kSwayLags[k] == 0.0) continue;
    before[k] = bend_[k];
    bend_[k] -= std::expm1(-dt / kSwayLags[k]) * (after[k] - bend_[k]);
    after[k] = bend_[k];
  }
}

void TyreRelaxation::advance(double way, double turn_rate, double lateral_acceleration) {
  for (std::size_t k = 0; k < kRelaxations.size(); ++k) {
    const double share = -std::expm1(-way / kRelaxations[k]);
    turn_rate_[k] += share * (turn_rate - turn_rate_[k]);
    lateral_acceleration_[k] += share * (lateral_acceleration - lateral_acceleration_[k]);
  }
}

/// The play operator (Krasnosel'skii and Pokrovskii, Systems with Hysteresis, 1989, section 2). What a
/// standing wheel shows of two counts is no motion, so a play of less loses its share of what is one. The
/// drive begins with the flanks that its first motion needs.
LostToPlay GearPlay::advance(double delta, double dither) {
  LostToPlay lost{};
  if (delta == 0.0) return lost;
  for (std::size_t k = 0; k < kPlays.size(); ++k) {
    const double play = std::max(kPlays[k], dither);
    if (!has_moved_) gap_[k] = delta > 0.0 ? play : 0.0;
    const double moved = gap_[k] + delta;
    const double pushed = moved > play ? moved - play : std::min(moved, 0.0);
    gap_[k] = moved - pushed;
    lost[k] = (delta - pushed) * kPlays[k] / play;
  }
  has_moved_ = true;
  return lost;
}

/// A wheel that trails by t turns towards the way s of its pivot: tan(beta / 2) falls as exp(-s / t), beta
/// the angle between both (Campion, Bastin and D'Andrea-Novel 1996, eq. 4: no slip across the wheel). A lean
/// turns it on by lean * s / t.
CasterSines CasterSwing::advance(const math::Pose& step, double track_width) {
  CasterSines sines{};
  const double across = -settings::kCasterBehind * track_width * step.yaw;
  const double way = std::hypot(step.x, across);
  const double towards = std::atan2(across, step.x);
  std::size_t k = 0;
  for (const double trail : kCasterTrails) {
    if (!(way > 0.0)) break;
    const double turns = way / trail, fading = std::exp(-turns);
    for (const double lean : kCasterLeans) {
      const double before = math::wrap_angle(direction_[k] - towards);
      const double after = 2.0 * std::atan(std::tan(before / 2.0) * fading) + lean * turns;
      sines[k] = 0.5 * (std::sin(before) + std::sin(after));
      direction_[k++] = towards + after;
    }
  }
  for (double& direction : direction_) direction -= step.yaw;
  return sines;
}

}  // namespace odomcalib::calib::vehicle
