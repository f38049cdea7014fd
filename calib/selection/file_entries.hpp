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

std::vector<ConsideredTerm> entries_of(const std::vector<Considered>& considered);

/// The change, its moment and size, and the state that the values stand for.
/// @param event a smooth term that happens at once
/// @param mount of the sensor on the base, since then
std::string event_to_text(const terms::FittedSmoothTerm& event, const math::Pose& mount);

/// The named findings about the lidar.
std::vector<EffectResult> effect_results(const std::vector<terms::LidarFinding>& findings);

/// Errors of the lidar without a name: the variables that they depend on, and the coefficients.
std::vector<LidarCurve> lidar_curves(const std::vector<terms::LidarFinding>& findings);

}  // namespace odomcalib::calib::selection
