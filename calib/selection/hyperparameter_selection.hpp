// The last word on the shape of a smooth term that was just added.
#pragma once

#include "calib/selection/search_result.hpp"

namespace odomcalib::calib::selection {

/// A term with a narrow peak needs more knots than finding it did, one of the past another memory. What other
/// shapes that are nearly as likely, or another zero, would make of the base parameters is not known about
/// them, and added to the model uncertainties.
/// @param result whose model ends with the newest of its smooth terms
void select_hyperparameters_of_newest(const FitTask& task, SearchResult& result);

}  // namespace odomcalib::calib::selection
