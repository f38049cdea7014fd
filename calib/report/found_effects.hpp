// Effects that a solve found or was given, with their values and their evidence.
#pragma once

#include <optional>
#include <vector>

#include "calib/report/findings.hpp"
#include "calib/selection/selection_json.hpp"

namespace odomcalib::calib::report {

/// Of the lidar, of its stamps, and of the wheels, the clocks and the floor. Smooth terms have no name and
/// are not among them.
/// @param plain fit of the base parameters alone to the same pairs; nullopt where it failed
std::vector<EffectResult> found_effects(const Findings& found,
                                        const std::optional<estimation::FitResult>& plain);

std::vector<selection::FittedSmoothTerm> found_smooths(const Findings& found);

}  // namespace odomcalib::calib::report
