// Units, clocks and idle streams of recordings, named before anything is measured with them.
#pragma once

#include <optional>
#include <span>

#include "proto/recording/recording.hpp"

namespace odomcalib::calib::ingest {

/// Why nothing can be calibrated from these recordings of one robot; nullopt when nothing speaks against
/// trying. Errors: empty (a stream is missing or carries a clock of its own, a wheel never turned in any of
/// them), missing_units, format (times, angles or ranges in other units than s, rad and m).
/// @param recordings one at least
std::optional<Error> check_recordings(std::span<const Recording> recordings);

}  // namespace odomcalib::calib::ingest
