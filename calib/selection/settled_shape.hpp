// The last word on the shape of a curve that was just added.
#pragma once

#include "calib/selection/search_result.hpp"

namespace odomcalib::calib::selection {

/// A law with a narrow peak needs more knots than finding it did, one of the past another memory. What other
/// shapes that are nearly as likely, or another zero, would make of the base parameters is not known about
/// them, and added to the doubts.
/// @param result whose model ends with the newest of its curves
void settle_shape_of_newest_curve(const FitTask& task, SearchResult& result);

}  // namespace odomcalib::calib::selection
