// Findings about the lidar in the terms of the calibration file.
#pragma once

#include <string>
#include <vector>

#include "calib/selection/lidar_trace.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::calib::selection {

/// The named ones.
std::vector<EffectResult> effect_results(const std::vector<terms::LidarFinding>& findings);

/// Member "lidar_smooths": what the lidar's error depends on without a name, and the coefficients.
inline constexpr const char* kLidarSmoothTermsMember = "lidar_curves";
std::string lidar_smooth_terms_to_json(const std::vector<terms::LidarFinding>& findings);

}  // namespace odomcalib::calib::selection
