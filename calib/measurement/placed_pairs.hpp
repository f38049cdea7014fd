// Pairs of keyframes, measured by matches, held against the scans' places in the map. Where walls leave a
// match loose (a corridor, a half-empty room) it slides the same way for minutes; a map of everything does
// not.
#pragma once

#include <vector>

#include "calib/measurement/placed_scan.hpp"
#include "calib/measurement/scan_path.hpp"
#include "calib/measurement/sensor_pair.hpp"

namespace odomcalib::calib::measurement {

/// Largest drift of the chained matches against the path, in deviations that independent errors of the stated
/// covariances would have: the larger of x, y (map axes) and yaw.
double drift_of_matches(const std::vector<SensorPair>& pairs, const ScanPath& path,
                        const PathOfWheels& wheels);

/// The same pairs with motions from place to place, each that of the nearest scan; pairs without one are left
/// out.
std::vector<SensorPair> pairs_of_places(const std::vector<SensorPair>& pairs, const ScanPath& path,
                                        const PathOfWheels& wheels);

}  // namespace odomcalib::calib::measurement
