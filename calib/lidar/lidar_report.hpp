// Findings about the lidar in the terms of the calibration file.
#pragma once

#include <string>
#include <vector>

#include "calib/lidar/lidar_trace.hpp"
#include "proto/calibration.hpp"

namespace odomcalib::calib {

/// The named ones.
std::vector<EffectResult> effect_results(const std::vector<LidarFinding>& findings);

/// Member "lidar_curves": what the lidar's error depends on without a name, and the coefficients.
inline constexpr const char* kLidarCurvesMember = "lidar_curves";
std::string lidar_curves_to_json(const std::vector<LidarFinding>& findings);

}  // namespace odomcalib::calib
