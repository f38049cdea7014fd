// Smooth terms that are not what is missing.
#pragma once

#include "calib/selection/fitted_model.hpp"

namespace odomcalib::calib::selection {

/// A term of two covariates at once (a wheel that drags in slow turns to the right) lends part of itself to a
/// term of either alone, which is wrong wherever the other differs: in another drive odometry is better
/// without it. Whether the smooth terms explain less than half of what odometry errs by over ten seconds, in
/// squares beyond what noise of reference and wheels makes of it.
/// @param without the same model but for the smooth terms
bool explain_too_little(const FitTask& task, const FittedModel& with, const FittedModel& without);

}  // namespace odomcalib::calib::selection
