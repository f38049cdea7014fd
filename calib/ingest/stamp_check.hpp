// Stamps that cannot be those of the samples: without their last digits, of a clock that was set by years.
#pragma once

#include <optional>

#include "calib/ingest/form.hpp"

namespace odomcalib::calib::ingest {

/// Whole seconds, numbers that are too large for the digits they are stored in, or one stamp for all.
/// Error: format.
std::optional<Error> lost_digits(const Recording& recording, Form form);

/// A clock that counted since boot and was set to the date, within one stream. Error: format.
std::optional<Error> clock_was_set(const Recording& recording, Form form);

/// Stamps that the reader could not take for seconds since any date. Error: format.
std::optional<Error> no_dates(const Recording& recording, Form form);

}  // namespace odomcalib::calib::ingest
