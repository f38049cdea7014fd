// A second opinion on a recording that could not be calibrated: the motion of the reference is measured
// without the wheels, and compared with the counts as they are and as they would be after each of the usual
// mistakes.
#pragma once

#include <optional>

#include "proto/recording/recording.hpp"

namespace odomcalib::calib::estimation {

/// The mistake without which counts and reference explain each other, as the reason to refuse the recording;
/// nullopt when none does, or nothing is wrong. Takes about as long as a first match of all scans.
std::optional<Error> first_look(const Recording& recording);

/// Whether the counts of a wheel never fall, or never grow: the sign of encoders without a direction.
bool counts_one_way(const Recording& recording);

/// The error that counts have no direction, where the reference turns as counts with one would have it;
/// nullopt where the robot only drove ahead. Matches scans only if a wheel counts one way only.
std::optional<Error> counts_without_direction(const Recording& recording);

/// The error that odometry is that of a frame beside the axle, where the lidar comes out as far beside its
/// nominal place as turns on the spot say. Matches scans only if these say so.
std::optional<Error> odometry_beside_axle(const Recording& recording);

}  // namespace odomcalib::calib::estimation
