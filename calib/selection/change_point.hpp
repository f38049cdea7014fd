// Events: what is otherwise from one moment on.
#pragma once

#include "calib/selection/fitted_model.hpp"
#include "calib/terms/smooth_term.hpp"

namespace odomcalib::calib::selection {

/// The event on top of the model at its most likely moment within a fourteenth of the drive.
terms::SmoothTerm at_likeliest_change_point(const FitTask& task, const FittedModel& model,
                                            const terms::SmoothTerm& event);

}  // namespace odomcalib::calib::selection
