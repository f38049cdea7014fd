// The delay between the clocks is fitted before anything else is known, and leaves where it turns out to be
// none.
#pragma once

#include "calib/estimation/fit.hpp"
#include "calib/selection/search_result.hpp"

namespace odomcalib::calib::selection {

/// How all fits of the pipeline settle.
/// @param may_prune clocks were not requested by name: those that run alike are left out
estimation::Settling settling(bool may_prune, const measurement::Progress& progress);

/// The model without parts of the clock that are idle (criterion.hpp), as it is to be fitted next.
vehicle::VehicleModel without_idle_clocks(const estimation::Fit& fit);

/// What an idle delay stood for may have got its own name: it leaves the model, or stays without being
/// reported where it is plain but short.
SearchResult without_idle_delay(const FitTask& task, SearchResult found);

}  // namespace odomcalib::calib::selection
