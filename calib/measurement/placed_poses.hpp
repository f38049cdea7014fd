// Poses of an external reference (motion capture, a localiser) as places of the sensor: each is noisy, many
// are known, and the wheels measure how one follows from the other.
#pragma once

#include <span>
#include <vector>

#include "calib/measurement/placed_scan.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::measurement {

/// Means of the poses of a tenth of a second each, carried to their middle by the wheels. Their covariance is
/// that of independent noise, estimated from how single poses scatter about the path of the wheels.
/// Headings go on beyond half a turn.
/// @param poses in time order
std::vector<PlacedScan> placed_poses(std::span<const PoseSample> poses, const PathOfWheels& wheels);

}  // namespace odomcalib::calib::measurement
