// A clock that is set ahead by so much while recording that the stamps alone show it.
#pragma once

#include "calib/measurement/dataset.hpp"

namespace odomcalib::calib::estimation {

/// A gap in the stamps of the counts, or of the reference, while the other goes on, is a clock that was set
/// ahead where the counts explain the rotation that follows it only without the gap; a device that fell
/// silent for as long is none. The data with the stamps after each leap put back, and said so in the
/// recording's `repairs`; without any the data given.
/// @param opened not measured yet
measurement::Dataset without_clock_leaps(measurement::Dataset opened);

}  // namespace odomcalib::calib::estimation
