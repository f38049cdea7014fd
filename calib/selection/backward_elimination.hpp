// What was added early and something added later explains better.
#pragma once

#include "calib/selection/search_result.hpp"

namespace odomcalib::calib::selection {

/// Takes names and smooth terms that are no longer needed out of the model and of the report, one after the
/// other. What was added last stays.
/// @param per_parameter that an effect has to take off -2 log L for each of its own
/// @return whether the model has changed
bool eliminate_superfluous(const FitTask& task, double per_parameter, SearchResult& result);

}  // namespace odomcalib::calib::selection
