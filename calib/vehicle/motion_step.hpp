// One tick interval as the model and the effects see it.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

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

/// Of an acceleration, how fast the speed or turn rate grows in magnitude: negative while it is braked,
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

/// What happened lately, fading over several spans, the usual one second: nobody knows how long a robot
/// remembers.
inline constexpr std::array<double, 8> kMemorySpans = {0.3, 1.0, 3.3, 0.2, 0.45, 0.67, 1.5, 2.2};
inline constexpr std::size_t kUsualMemory = 1;
using Memory = std::array<double, kMemorySpans.size()>;

/// m/s^2; what an acceleration of such size moved stays until one the other way (the relay of Krasnosel'skii
/// and Pokrovskii, Systems with Hysteresis, 1989, section 28, its thresholds symmetrical).
inline constexpr std::array<double, 13> kAccelerationThresholds = {0.1,  0.12, 0.145, 0.17, 0.205, 0.25, 0.3,
                                                                   0.36, 0.43, 0.5,   0.6,  0.75,  0.9};
/// Means as in Memory, then relays.
using AccelerationMemory = std::array<double, kMemorySpans.size() + kAccelerationThresholds.size()>;

/// s; how long a robot has to stand until something sticks is not known either. Shorter stops are reversals.
inline constexpr std::array<double, 14> kStops = {0.12,  0.14, 0.155, 0.17, 0.19, 0.21, 0.23,
                                                  0.255, 0.28, 0.31,  0.34, 0.37, 0.41, 0.45};

/// rad; the play of a gear train is not known either (Renard numbers, ISO 3, R10).
inline constexpr std::array<double, 20> kPlays = {0.004, 0.005, 0.0063, 0.008, 0.01, 0.0125, 0.016,
                                                  0.02,  0.025, 0.0315, 0.04,  0.05, 0.063,  0.08,
                                                  0.1,   0.125, 0.16,   0.2,   0.25, 0.315};
using LostToPlay = std::array<double, kPlays.size()>;

/// m; trails of casters are not known either ...
inline constexpr std::array<double, 6> kCasterTrails = {0.02, 0.028, 0.04, 0.057, 0.08, 0.113};
/// ... nor by how much a caster that has settled still points past its way, rad: to which side it falls after
/// a straight motion is reversed hangs on this alone.
inline constexpr std::array<double, 5> kCasterLeans = {0.0, -0.002, 0.002, -0.01, 0.01};
inline constexpr std::size_t kCasters = kCasterTrails.size() * kCasterLeans.size();  ///< by trail, then lean

/// m; nor are the ways over which tyres take up a slip angle (Pacejka, Tire and Vehicle Dynamics,
/// chapter 7).
inline constexpr std::array<double, 3> kRelaxations = {0.03, 0.07, 0.15};

/// s; the time constants by which a mast may follow the base's acceleration late, the usual one second (see
/// kUsualMemory).
inline constexpr std::array<double, 4> kSwayLags = {0.05, 0.0, 0.1, 0.2};
using Sways = std::array<double, kSwayLags.size()>;

/// What unwinds after a stop of what a motion has wound up, as shares of the most it can: a straight motion
/// winds up by its way, one on the spot by its turn, -1 to 1 in all.
struct Unwound {
  double way = 0.0;
  double turn = 0.0;
};
/// The next few centimetres wind up anew whatever they are, as they do with the side walls of tyres; or a
/// turn stays wound up until another.
inline constexpr std::size_t kWindings = 2;

/// Everything observable about one tick interval; effects depend on nothing else. Speeds and accelerations
/// are smoothed, since differences of raw ticks are mostly quantisation noise.
/// What waves of the place and the day depend on comes first, in one line of memory: thousands are tried.
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
  double left_acceleration_change = 0.0,
         right_acceleration_change = 0.0;  ///< over the interval, m/s^2
  double relative_speed = 0.0;  ///< mean speed of the rims of late, in units of the least that is no standing
  double forward_acceleration = 0.0;  ///< m/s^2
  /// Which it comes to before it falls below the least threshold, m/s^2.
  double peak_acceleration = 0.0;
  double speed = 0.0;                                           ///< forward, m/s
  double turn_rate = 0.0;                                       ///< rad/s
  Sways turn_acceleration_before{}, turn_acceleration_after{};  ///< rad/s^2, at begin and end, late by each
  /// What makes tyres slip sideways, its sign that of the force, lagging by each of kRelaxations: the turn
  /// rate, rad/s, and the lateral acceleration, m/s^2. Not smoothed: the tyres do that.
  std::array<double, kRelaxations.size()> relaxed_turn_rate{}, relaxed_lateral_acceleration{};
  double way =
      0.0;  ///< of the base in its direction, m; not smoothed, so that in a spin ticks give either sign
  double since_reversal = 0.0;       ///< distance driven since the direction of travel last changed, m
  double left_since_reversal = 0.0;  ///< rotation of the wheel since it last reversed, rad, at the begin
  double right_since_reversal = 0.0;
  /// Of the wheel's rotation in the interval, what a gear train with each of kPlays loses, rad.
  LostToPlay left_lost{}, right_lost{};
  /// Mean way of the two rims since the robot last stood still for each of kStops, m.
  std::array<double, kStops.size()> since_stop{};
  Memory previous_turn{};  ///< which way it turned lately: mean of the turn's sign over a radian, -1 to 1
  /// Whether it was sped up or slowed down lately: the same over 0.1 m/s.
  AccelerationMemory previous_acceleration{};
  /// Sine of the angle by which a caster behind the axle still points past the way its pivot moves, for each
  /// trail and lean: -1 to 1.
  std::array<double, kCasters> caster{};
  std::array<Unwound, kWindings> unwound{};  ///< in this interval, by each way of winding up
  double fastest = 0.0;                      ///< rim speed since the robot last stood, m/s
  double direction = 0.0;                    ///< sign of the forward speed, kept while standing

  void face(double yaw) {
    heading = yaw;
    heading_cosine = std::cos(yaw);
    heading_sine = std::sin(yaw);
  }
};

}  // namespace odomcalib::calib::vehicle
