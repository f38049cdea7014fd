// Smooth terms that are worth asking for, and the other shapes of one that was found.
#pragma once

#include <span>
#include <vector>

#include "calib/terms/smooth_term.hpp"
#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::terms {

/// Smooth terms worth trying on this data: every sensible (covariate, channel) whose covariate varies, on its
/// 0.5 to 99.5 % range, higher harmonics of the wheels, and periods of time between 8 s and two thirds of the
/// recording.
std::vector<SmoothTerm> candidate_smooths(std::span<const vehicle::DriveModel* const> models);

/// The same term in other shapes: splines more or less smooth, other ways to understand what happened before.
std::vector<SmoothTerm> other_shapes(const SmoothTerm& smooth,
                                     std::span<const vehicle::DriveModel* const> models);

}  // namespace odomcalib::calib::terms
