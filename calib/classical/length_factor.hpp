// Lengths that come out as a round multiple of their nominal values: which number in the description, or of
// the reference, has that factor in it.
#pragma once

#include <optional>
#include <string>

#include "proto/measurements.hpp"

namespace odomcalib::calib::classical {

/// Estimated over nominal.
struct LengthRatios {
  double left = 1.0, right = 1.0, track = 1.0;
};

/// What was found and what mends it.
struct Cause {
  std::string what, remedy;
};

/// The cause when the ratios make one of the known patterns: all three alike (units, scale of the reference),
/// both diameters alike (counts per turn, radius or circumference instead of diameter), the track alone, one
/// wheel alone. nullopt when they are near one, or make no pattern.
/// @param of_poses the reference is poses, not ranges
std::optional<Cause> cause_of_ratios(const LengthRatios& ratios, const RobotDescription& robot,
                                     bool of_poses);

}  // namespace odomcalib::calib::classical
