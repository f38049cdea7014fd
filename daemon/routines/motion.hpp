// Guided motions as data: a plan is a list of moves, each one a body twist along a path of known length.
// Nothing here reads a clock or a device.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "daemon/routines/settings.hpp"

namespace odomcalib::routines {

/// Pose of the base: m, m, rad.
struct Pose {
  double x = 0.0, y = 0.0, yaw = 0.0;
};

/// Body velocity: forward m/s, counter-clockwise rad/s.
struct Twist {
  double v = 0.0, w = 0.0;
};

/// Wheel angular velocities, rad/s, forward positive on both sides.
struct WheelRates {
  double left = 0.0, right = 0.0;
};

/// Nominal lengths, m.
struct WheelGeometry {
  double left_wheel_diameter = 0.0, right_wheel_diameter = 0.0, track_width = 0.0;
};

struct Limits {
  double speed = settings::kCapSpeed_m_s;                     ///< m/s
  double turn_rate = settings::kCapRate_rad_s;                ///< rad/s
  double acceleration = settings::kCapAcceleration;           ///< m/s^2
  double turn_acceleration = settings::kCapTurnAcceleration;  ///< rad/s^2
};

/// Caps that no configuration can raise (rule M7).
constexpr Limits kCaps{};

/// The wanted limits, each lowered to its cap; a value that is no positive number becomes the cap.
Limits capped(const Limits& wanted);

/// Pure rolling; zero for a geometry without lengths or a twist that is not finite (rule M17).
WheelRates to_wheels(const Twist& twist, const WheelGeometry& geometry);

/// Smallest equivalent angle, in [-pi, pi].
double wrapped(double angle);

/// Motion along one straight line or circle, from rest to rest.
struct Move {
  std::string name;
  Twist direction = {};    ///< twist per unit of pace: (+-1, 0) straight, (0, +-1) spin, (+-r, +-1) arc
  double amount = 0.0;     ///< m along the line, or rad of turn when direction.w is not zero
  double pace = 0.0;       ///< m/s or rad/s
  double late_pace = 0.0;  ///< pace of the second half, 0: the same
  double settle = settings::kSettle_s;  ///< s at rest afterwards
  double haste = 1.0;                   ///< share of the acceleration that the limits allow, a tenth at least
  /// The amount is that of the commands, whatever the odometry says: for wheels whose counts may be wrong.
  bool open_loop = false;
  /// Turn on the spot to this heading, relative to that at the start of the plan, on the shorter way;
  /// direction and amount are found at the start of the move.
  std::optional<double> heading = std::nullopt;
};

Move straight(double distance, double speed, double settle = settings::kSettle_s);
Move spin(double angle, double rate, double settle = settings::kSettle_s);
/// @param radius m, from the middle of the axle to the centre of the circle, positive
/// @param angle rad of turn, signed; @param forward driving direction
Move arc(double radius, double angle, double rate, bool forward, double settle = settings::kSettle_s);
Move turn_to(double heading, double rate);

struct Plan {
  std::string name;
  std::vector<Move> moves;
  Limits limits;
};

/// Time that a robot without lag needs for one move, settling included, s.
double expected_duration(const Move& move, const Limits& limits);

struct Preview {
  double duration = 0.0;  ///< s
  /// Poses that differ from each other: a plan that comes by a place again and again has one for it, so their
  /// number is bounded by the way and not by the time.
  std::vector<Pose> path;
  Pose end;               ///< where the plan leaves the robot
  double reach = 0.0;     ///< m, farthest point of the path from its start
  double heading = 0.0;   ///< rad, largest heading away from that of the start, continuous over full turns
  double distance = 0.0;  ///< m, longest single straight move
  double turn = 0.0;      ///< rad, largest turn of a single move
};

/// Drives the plan with an ideal robot from the origin.
Preview preview(const Plan& plan);

/// Poses along a way, each once.
class DistinctPoses {
 public:
  /// @param place m and @param heading rad, of poses that are one
  DistinctPoses(double place, double heading) : place_(place), heading_(heading) {}

  void add(const Pose& pose);
  std::vector<Pose> take() && { return std::move(poses_); }

 private:
  [[nodiscard]] std::uint64_t cell_of(const Pose& pose) const;

  double place_, heading_;
  std::unordered_set<std::uint64_t> taken_;
  std::uint64_t last_ = 0;
  std::vector<Pose> poses_;
};

}  // namespace odomcalib::routines
