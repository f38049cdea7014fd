// How well the lidar keeps its metre.
#pragma once

#include <span>
#include <vector>

#include "calib/selection/lidar_trace.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::selection {

/// Standard deviation, relative, of a length that was measured with scans in which errors of the range were
/// left: half the RMS of their slope, d(error)/d(range), over what the scans see, so that one as large as the
/// slope is two deviations off. Which part of the slope is a common scale no scan shows.
/// @param findings those that scans are corrected by do not count
double range_scale_uncertainty(const std::vector<terms::LidarFinding>& findings,
                               std::span<const Recording> recordings);

}  // namespace odomcalib::calib::selection
