// Findings in the calibration file: what was considered, those of the lidar; change points in words for a
// user.
#pragma once

#include <string>
#include <vector>

#include "calib/math/se2.hpp"
#include "calib/selection/search_result.hpp"
#include "calib/terms/fitted_smooth_term.hpp"
#include "calib/terms/lidar_effect.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::calib::selection {

std::string considered_to_json(const std::vector<Considered>& considered);

/// The change, its moment and size, and the state that the values stand for.
/// @param event a smooth term that happens at once
/// @param mount of the sensor on the base, since then
std::string event_to_text(const terms::FittedSmoothTerm& event, const math::Pose& mount);

/// The named findings about the lidar.
std::vector<EffectResult> effect_results(const std::vector<terms::LidarFinding>& findings);

/// Member "lidar_smooths": what the lidar's error depends on without a name, and the coefficients.
inline constexpr const char* kLidarSmoothTermsMember = "lidar_curves";
std::string lidar_smooth_terms_to_json(const std::vector<terms::LidarFinding>& findings);

}  // namespace odomcalib::calib::selection
