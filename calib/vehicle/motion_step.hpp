// One tick interval as the model and the effects see it.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "calib/vehicle/covariates.hpp"

namespace odomcalib::calib::vehicle {

/// Base motion in one tick interval before integration, m and rad.
template <typename T>
struct WheelStep {
  T left{0.0};  ///< travel of the left wheel
  T right{0.0};
  T side{0.0};   ///< sideways motion of the base, left positive
  T yaw{0.0};    ///< rotation in addition to (right - left) / track_width
  T track{1.0};  ///< factor on the track width
};

/// Growth of the magnitude of a speed or turn rate by an acceleration: negative while it is braked,
/// whichever way the motion goes.
inline double growth_of_speed_magnitude(double acceleration, double speed) {
  return std::copysign(acceleration, acceleration * speed);
}

/// Place of the nearest of values of which only these are known.
template <std::size_t N>
std::size_t nearest_of(const std::array<double, N>& values, double value) {
  std::size_t best = 0;
  for (std::size_t k = 1; k < N; ++k)
    if (std::abs(values[k] - value) < std::abs(values[best] - value)) best = k;
  return best;
}

/// Everything observable about one tick interval; effects depend on nothing else. Speeds and accelerations
/// are smoothed, since differences of raw ticks are mostly quantisation noise.
/// Fields for waves of the place and the day come first, in one cache line: thousands of waves are tried.
struct alignas(64) StepContext {
  double t = 0.0;        ///< middle of the interval, s after the recording's first sample
  double dt = 0.0;       ///< s
  double heading = 0.0;  ///< rad, from the plain model
  double heading_cosine = 1.0, heading_sine = 0.0;           ///< more than a thousand waves need them
  double x = 0.0, y = 0.0;                                   ///< m, from the plain model
  double distance = 0.0;                                     ///< way so far, forward and backward alike, m
  double left_angle = 0.0, right_angle = 0.0;                ///< cumulative wheel angle, rad
  double left_delta = 0.0, right_delta = 0.0;                ///< wheel rotation in the interval, rad
  double left_speed = 0.0, right_speed = 0.0;                ///< wheel rim speed, m/s
  double left_acceleration = 0.0, right_acceleration = 0.0;  ///< m/s^2
  double speed = 0.0;                                        ///< forward, m/s
  double turn_rate = 0.0;                                    ///< rad/s
  double direction = 0.0;  ///< sign of the forward speed, kept while standing
  double way =
      0.0;  ///< of the base in its direction, m; not smoothed, so that in a spin ticks give either sign
  double since_reversal = 0.0;       ///< distance driven since the direction of travel last changed, m
  double left_since_reversal = 0.0;  ///< rotation of the wheel since it last reversed, rad, at the begin
  double right_since_reversal = 0.0;

  // The rest is zero where nothing asks for its group.

  /// CovariateGroup::acceleration_changes: over the interval, m/s^2.
  double left_acceleration_change = 0.0, right_acceleration_change = 0.0;
  /// sway: rad/s^2, at begin and end, late by each of kSwayLags.
  Sways turn_acceleration_before{}, turn_acceleration_after{};
  /// tyre_relaxation: what makes tyres slip sideways, its sign that of the force, lagging by each of
  /// kRelaxations: the turn rate, rad/s, and the lateral acceleration, m/s^2. Not smoothed: the tyres do
  /// that.
  Relaxed relaxed_turn_rate{}, relaxed_lateral_acceleration{};
  /// stops: mean speed of the rims of late, in units of the least that is no standing; and the mean way of
  /// the two rims since the robot last stood still for each of kStops, m.
  double relative_speed = 0.0;
  SinceStop since_stop{};
  /// winding: what unwinds in this interval, by each way of winding up, and the rim speed since the robot
  /// last stood, m/s.
  std::array<ReleasedWinding, kWindings> unwound{};
  double fastest = 0.0;
  /// previous_turn: which way it turned lately, mean of the turn's sign over a radian, -1 to 1.
  Memory previous_turn{};
  /// previous_acceleration: forward, and what it comes to before it falls below the least threshold, m/s^2;
  /// whether the robot was sped up or slowed down lately, as in previous_turn over 0.1 m/s.
  double forward_acceleration = 0.0, peak_acceleration = 0.0;
  AccelerationMemory previous_acceleration{};

  std::uint32_t interval = 0;           ///< which of the drive this is
  const OnDemand* on_demand = nullptr;  ///< of the drive, outlives the context; without: zero

  /// gear_play: see LostByWheels.
  [[nodiscard]] const LostByWheels& lost_to_play() const {
    return on_demand != nullptr ? on_demand->lost_to_play(interval) : kNothingLost;
  }
  /// caster: sine of the angle by which a caster behind the axle still points past the way its pivot moves,
  /// for each trail and lean, -1 to 1.
  [[nodiscard]] const CasterSines& caster() const {
    return on_demand != nullptr ? on_demand->caster(interval) : kNoSwing;
  }

  void face(double yaw) {
    heading = yaw;
    heading_cosine = std::cos(yaw);
    heading_sine = std::sin(yaw);
  }
};

}  // namespace odomcalib::calib::vehicle
