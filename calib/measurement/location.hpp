// Where the base was, from what is not a wheel: floors, slopes and cables act on places and headings, and
// nominal dead reckoning loses both within minutes.
#pragma once

#include <vector>

#include "calib/measurement/scan_path.hpp"
#include "calib/vehicle/drive_model.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::measurement {

/// Poses of the base, relative to the first one.
/// @param mount of the sensor on the base
std::vector<vehicle::Fix> fixes_of(const ScanPath& path, const math::Pose& mount);

/// Of the reference poses, which are the base's own; none for recordings without.
std::vector<vehicle::Fix> fixes_of(const Recording& recording);

}  // namespace odomcalib::calib::measurement
