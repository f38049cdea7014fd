// The last word on the shape of a smooth term that was just added, and on the moment of an event.
#pragma once

#include "calib/selection/fitted_model.hpp"
#include "calib/selection/search_result.hpp"
#include "calib/terms/smooth_term.hpp"

namespace odomcalib::calib::selection {

/// A term with a narrow peak needs more knots than finding it did, one of the past another memory. What other
/// shapes that are nearly as likely, or another zero, would make of the base parameters is not known about
/// them, and added to the model uncertainties.
/// @param result whose model ends with the newest of its smooth terms
void select_hyperparameters_of_newest(const FitTask& task, SearchResult& result);

/// The event on top of the model at its most likely moment within a fourteenth of the drive.
terms::SmoothTerm at_likeliest_change_point(const FitTask& task, const FittedModel& model,
                                            const terms::SmoothTerm& event);

}  // namespace odomcalib::calib::selection
