// Drives for recordings without wires. Speeds follow from the nominal geometry, as a host would compute them.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "tests/sim/world/truth.hpp"

namespace odomcalib::sim {

/// Wheel speeds in rad/s.
struct WheelCommand {
  double left = 0.0, right = 0.0;
};

/// Called every control period with the time and the pose that odometry believes in (nominal parameters, from
/// 0, 0, 0).
using Drive = std::function<WheelCommand(double t, const Pose& odometry)>;

/// v in m/s, yaw rate in rad/s, for a time in s.
struct Manoeuvre {
  double speed = 0.0, yaw_rate = 0.0, duration = 0.0;
  double from = 1.0,
         to = 1.0;  ///< shares of both at the beginning and at the end, changing evenly in between
};

/// Way of the base, m, negative backward.
double way_of(const Manoeuvre& move);

WheelCommand wheel_command(const Geometry& nominal, double speed, double yaw_rate);
double total_duration(const std::vector<Manoeuvre>& manoeuvres);
/// One manoeuvre after the other, then rest.
Drive follow(const Geometry& nominal, std::vector<Manoeuvre> manoeuvres);

/// Straights both ways at three speeds on four headings, spins both ways at three rates, arcs in all
/// quadrants, turns on one wheel, with and without stops in between: some five minutes on about 2 m x 2 m.
/// @param rest of a stop, s, braking included: with 0.4 fast wheels hardly come to stand still
std::vector<Manoeuvre> guided_pattern(double rest = 0.4);
/// The same kinds of motion as a careful engineer drives them: every speed up to the highest is passed slowly
/// too, and no two stops or pushes in a row are alike. Some five minutes on about 2 m x 2 m.
std::vector<Manoeuvre> varied_pattern();
/// Forward only at one speed with a few wide turns: what an impatient user drives. Needs about 3 m about the
/// start.
std::vector<Manoeuvre> lazy_pattern();
/// Random arcs of 1 to 4 s that stay within `radius` of the start as odometry sees it.
Drive random_drive(const Geometry& nominal, std::uint64_t seed, double radius = 1.2);

/// Radius that has to be free about a tour's start, m: a robot comes to stand half a metre too far.
inline constexpr double kTourRoom = 2.7;

/// As robots drive at work: forward in arcs at all speeds, turning on the spot where the area ends.
Drive tour_drive(const Geometry& nominal, std::uint64_t seed, double radius = 2.2);

}  // namespace odomcalib::sim
