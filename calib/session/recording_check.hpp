// Units, clocks and idle streams of a recording, told by name before anything is measured with them.
#pragma once

#include <optional>

#include "proto/recording.hpp"

namespace odomcalib::calib {

/// Why nothing can be calibrated from this recording; nullopt when nothing speaks against trying.
/// Errors: empty (a stream is missing, stands still, or carries a clock of its own), missing_units, format
/// (times, angles or ranges in other units than s, rad and m).
std::optional<Error> check_recording(const Recording& recording);

}  // namespace odomcalib::calib
