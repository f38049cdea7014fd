// Events: what is otherwise from one moment on.
#pragma once

#include <cstddef>
#include <optional>

#include "calib/selection/search_round.hpp"

namespace odomcalib::calib::selection {

/// The event on top of the model at its most likely moment within a fourteenth of the drive.
terms::SmoothTerm at_likeliest_change_point(const FitTask& task, const FittedModel& model,
                                            const terms::SmoothTerm& event);

/// A wheel that changes bit by bit explains three quarters of one that changes at once, and bends of its
/// function most of the rest.
/// @return the event of the wheels, if it explains more than the name
std::optional<std::size_t> event_instead_of(const FitTask& task, const SearchRound& round, const Trial& name);

}  // namespace odomcalib::calib::selection
