// Errors that repeat themselves with the way that something has rolled, as a caster, a belt or a wheel of a
// gear does, or in time, more often than periods are tried one by one.
#pragma once

#include <span>
#include <vector>

#include "calib/selection/candidate.hpp"
#include "calib/selection/fitted_model.hpp"

namespace odomcalib::calib::selection {

/// Waves of 0.2 to 1.5 m over the way of the base, which turn it, and over that of each wheel, which scale
/// its travel: of each the one that stands out of the residual, if one does decisively. None of more than
/// one recording, whose phases have no common origin. The same of the shortest periods in time in a long
/// drive, see terms::settings::kMostCycles. Odometry cannot follow them: what rolls on its own
/// begins at an unknown angle the next time.
std::vector<Candidate> rolling_waves(std::span<const measurement::FitData> data, const FittedModel& model);

}  // namespace odomcalib::calib::selection
