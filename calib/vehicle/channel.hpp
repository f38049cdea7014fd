// Covariates that a defect may depend on, and channels by which it enters the motion: the words of which
// effects and smooth terms are made.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "calib/vehicle/covariates.hpp"
#include "calib/vehicle/motion_step.hpp"

namespace odomcalib::calib::vehicle {

/// Observable covariates of a tick interval.
enum class Covariate {
  left_speed,
  right_speed,
  wheel_speed,  ///< of each wheel for itself, both alike
  speed,
  turn_rate,
  lateral_acceleration,
  left_acceleration,
  right_acceleration,
  acceleration,  ///< of the base, forward
  turn_acceleration,
  left_phase,
  right_phase,
  time,
  heading,
  position,  ///< x and y together
  distance,  ///< way so far; of waves only
  since_reversal,
  left_since_reversal,
  right_since_reversal,
  since_stop,
  previous_turn,
  previous_acceleration,
};
inline constexpr Covariate kLastCovariate = Covariate::previous_acceleration;
std::string to_string(Covariate covariate);
/// In which it is computed; none where every interval has it.
CovariateGroups groups_of(Covariate covariate);
/// nullopt when there is none of that name.
std::optional<Covariate> covariate_from(const std::string& name);
/// The manoeuvre that shows the most of what depends on it, in a small area; empty: none.
std::string manoeuvre_for(Covariate covariate);

/// Dependence on time, heading or position is a property of the day or of the place, not of the robot.
bool belongs_to_the_place(Covariate covariate);
/// Counted from where each recording begins: recordings of one robot share no zero of it.
bool begins_with_the_recording(Covariate covariate);
/// A speed or turn rate whose sign is the direction.
bool is_signed_speed(Covariate covariate);
/// Acceleration of a wheel, or of the base forward or to the side.
bool is_acceleration(Covariate covariate);
/// Phase of a wheel.
bool is_phase(Covariate covariate);
bool is_angle(Covariate covariate);
/// The robot's last turn or acceleration, however long ago.
bool is_memory(Covariate covariate);
/// A distance or angle since an event: the defect fades with it.
bool is_distance_since(Covariate covariate);
/// The latter.
bool is_angle_of_a_wheel(Covariate covariate);

/// In how many ways the covariate can be understood; all but the usual one are tried once it is found.
std::size_t memories_of(Covariate covariate);
/// Its sign stays until the opposite happens, instead of fading.
bool is_relay(Covariate covariate, std::size_t memory);

/// Value in an interval; of the position, x; of each wheel's own covariate, the left wheel's.
/// @param memory index of the span over which what happened before fades, of the size that an acceleration
/// must have (kAccelerationThresholds, after the spans), of the time for which it must have stood still
double value_of(Covariate covariate, const StepContext& context, std::size_t memory = kUsualMemory);

/// `travel` is signed and reverses with the motion, `path` is unsigned. Left, right, both: relative to the
/// travel of those wheels. Track: relative. Sideways: m per m of the base. Yaw path: rad per m of the base.
/// Turn path: m ahead per rad of turning either way. Turn side: m to the left per rad of turning to the left,
/// as if the centre of turning lay ahead by f. Scale: relative, of all lengths, which leaves turns as they
/// are: the lidar's own metre. Turn ahead: m ahead per rad of turning to the left, as a sensor sees it that
/// sits so far to the right of where it is thought to be. Way turned: rad by which a sensor sees the way
/// turned to the left, as one does that was itself turned to the right. Sensor yaw: rad by which the sensor
/// has turned on the base; f is its growth over the interval, so that it comes and goes with the covariate.
enum class Channel {
  left_travel,
  right_travel,
  both_travel,
  track,
  sideways,
  left_path,
  right_path,
  both_path,
  sideways_path,
  yaw_path,
  turn_path,
  turn_side,
  turn_ahead,
  way_turned,
  scale,
  sensor_yaw,
};
inline constexpr Channel kLastChannel = Channel::sensor_yaw;
std::string to_string(Channel channel);
/// On which a free term of the covariate is tried. In drives both ways a defect of the signed way and one of
/// the unsigned way are two terms. What one wheel does moves the base sideways by no mechanism: such a term,
/// found in straights and spins, was nonsense in circles.
std::span<const Channel> channels_of(Covariate covariate);
/// Signed counterpart of an unsigned way: whatever depends on a speed may change either, and only the
/// direction distinguishes them. Any other channel is its own.
Channel signed_counterpart(Channel channel);

/// To the left by f, rad.
template <typename T>
void turn_way(const T& f, WheelStep<T>& step) {
  using std::cos;
  using std::sin;
  const T ahead = 0.5 * (step.left + step.right), cosine = cos(f), sine = sin(f);
  const T change = ahead * cosine - step.side * sine - ahead;
  step.side = step.side * cosine + ahead * sine;
  step.left += change;
  step.right += change;
}

/// Lets a defect of size f act on the step.
template <typename T>
void carry(Channel channel, const StepContext& c, const T& f, WheelStep<T>& step) {
  const double way = c.speed < 0.0 ? -1.0 : 1.0;
  const double path = way * c.speed * c.dt;
  const double turn = (c.turn_rate < 0.0 ? -c.turn_rate : c.turn_rate) * c.dt;
  switch (channel) {
    case Channel::left_travel:
      step.left *= 1.0 + f;
      break;
    case Channel::right_travel:
      step.right *= 1.0 + f;
      break;
    case Channel::both_travel:
      step.left *= 1.0 + f;
      step.right *= 1.0 + f;
      break;
    case Channel::track:
      step.track *= 1.0 + f;
      break;
    case Channel::sideways:
      step.side += f * (way * path);
      break;
    case Channel::left_path:
      step.left *= 1.0 + (c.left_delta < 0.0 ? -f : f);
      break;
    case Channel::right_path:
      step.right *= 1.0 + (c.right_delta < 0.0 ? -f : f);
      break;
    case Channel::both_path:
      step.left += f * path;
      step.right += f * path;
      break;
    case Channel::sideways_path:
      step.side += f * path;
      break;
    case Channel::yaw_path:
      step.yaw += f * path;
      break;
    case Channel::turn_path:
      step.left += f * turn;
      step.right += f * turn;
      break;
    case Channel::turn_side:
      step.side -= f * (c.turn_rate * c.dt);
      break;
    case Channel::turn_ahead:
      step.left += f * (c.turn_rate * c.dt);
      step.right += f * (c.turn_rate * c.dt);
      break;
    case Channel::way_turned:
      turn_way(f, step);
      break;
    case Channel::scale:
      step.left *= 1.0 + f;
      step.right *= 1.0 + f;
      step.track *= 1.0 + f;
      break;
    case Channel::sensor_yaw:
      step.yaw += f;
      break;
  }
}

/// One covariate on one channel, whatever the function.
struct Dependence {
  Covariate covariate = Covariate::speed;
  Channel channel = Channel::both_travel;
  friend bool operator==(const Dependence&, const Dependence&) = default;
};

/// Dependence of both wheels alike, of each on its own speed.
inline constexpr Dependence kOfEachWheel{Covariate::wheel_speed, Channel::both_travel};

}  // namespace odomcalib::calib::vehicle
