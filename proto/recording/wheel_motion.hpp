// Wheel counts of what tells the motion of the wheels without counting: angles, speeds, odometry.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "proto/measurements.hpp"

namespace odomcalib {

/// Counts a turn where none are known: rounding to them (6 urad, at a wheel of 0.2 m diameter 0.6 um) is far
/// below what any encoder resolves, and a wheel can turn 8e9 times before a count leaves 2^53.
inline constexpr double kFineCountsPerRev = 1 << 20;

/// How a recording's choices begin where its counts were made of something else.
inline constexpr const char* kMotionFrom = "wheel motion from ";

/// The count nearest to an angle in rad; zero for one that no double counts exactly.
std::int64_t count_of(double angle, double counts_per_rev);

struct MadeTicks {
  std::vector<TickSample> ticks;
  double ticks_per_rev = kFineCountsPerRev;
};

/// Counts of cumulative angles, sorted by time. Angles that a driver keeps within one turn are continued.
/// @param stated counts a turn; where all angles lie on its grid the counts are those that the encoder made,
///   else (and with 0) the fine ones
MadeTicks ticks_from_wheels(const std::vector<WheelSample>& wheels, double stated);

/// Counts of speeds, each held until the next sample, sorted by time.
MadeTicks ticks_from_wheel_speeds(const std::vector<WheelSample>& speeds);

/// Whether odometry began anew between two poses: a return to exactly the origin.
bool is_reset(const PoseSample& before, const PoseSample& pose);

/// Counts of the poses that a robot computed with its nominal values, sorted by time. A reset begins a new
/// segment.
MadeTicks ticks_from_odometry(const std::vector<PoseSample>& poses, const RobotDescription& robot);

/// Ways of the left and the right wheel, in m, between two poses (x, y, yaw) of odometry.
std::array<double, 2> wheel_ways(const std::array<double, 3>& from, const std::array<double, 3>& to,
                                 double track_width);

}  // namespace odomcalib
