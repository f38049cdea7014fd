// Lengths that come out as a round multiple of their nominal values: which number in the description, or of
// the reference, has that factor in it.
#pragma once

#include <optional>
#include <string>

#include "proto/measurements.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::classical {

/// Estimated over nominal.
struct LengthRatios {
  double left = 1.0, right = 1.0, track = 1.0;
};

/// A cause that was found and its remedy.
struct Cause {
  std::string what, remedy;
};

/// Robot, motion source and reference that the ratios were measured with.
struct Measured {
  RobotDescription robot;
  MotionSource motion = MotionSource::ticks;  ///< what told the motion of the wheels
  bool of_poses = false;                      ///< the reference is poses, not ranges
};

/// The cause when the ratios make one of the known patterns: all three alike (units, scale of the reference,
/// of odometry), both diameters alike (counts per turn, the unit of angles or speeds, radius or circumference
/// instead of diameter), the track alone, one wheel alone. What is advised fits what told the motion. nullopt
/// when they are near one, or make no pattern.
std::optional<Cause> cause_of_ratios(const LengthRatios& ratios, const Measured& measured);

}  // namespace odomcalib::calib::classical
