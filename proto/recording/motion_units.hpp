// Units in which programs tell the motion of wheels, besides rad, rad/s and m.
#pragma once

#include <span>
#include <string>

#include "proto/measurements.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib {

struct MotionUnit {
  MotionSource source;
  const char* words;    ///< what it is called in a sentence
  double size;          ///< of the SI unit: numbers in it are 1 / size times as large; 0: see of_rim
  double of_rim = 0.0;  ///< m, of the way that the rim goes; 0: not told by its way
};

/// All that are known, of wheels, wheel_speeds and odometry (its x and y).
std::span<const MotionUnit> motion_units();

/// The SI unit of a source: "rad", "rad/s", "m"; "counts" of ticks.
const char* si_unit_of(MotionSource source);

/// How many times as large as in the SI unit the numbers are.
double factor_of(const MotionUnit& unit, const RobotDescription& robot);

}  // namespace odomcalib
