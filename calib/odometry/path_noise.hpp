// How far dead reckoning may be off after a path, when nothing but chance disturbs the wheels.
#pragma once

#include <array>
#include <span>

#include "proto/measurements.hpp"

namespace odomcalib::calib::odometry {

/// Standard deviations of an increment one metre long, forward and sideways in m, in heading in rad:
/// variances grow with the way that the wheels roll, so that those of a longer one grow with its root.
using IncrementNoise = std::array<double, 3>;

/// Standard deviations x, y in the frame of the first pose and yaw of the last one: m, m, rad. First order in
/// the errors, increments independent of each other.
/// @param track_width m: wheels roll in turns on the spot, too
std::array<double, 3> deviation_at_end(std::span<const PoseSample> path, const IncrementNoise& noise,
                                       double track_width);

}  // namespace odomcalib::calib::odometry
