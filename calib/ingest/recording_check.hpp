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

/// Why these recordings are of two robots; nullopt where those that state a robot or its size state the same.
/// Errors: format (their nominal lengths or ticks per turn differ), refused (they name different robots).
/// @param same_robot somebody says that they are of one, whatever names they carry
std::optional<Error> two_robots(std::span<const Recording> recordings, bool same_robot);

}  // namespace odomcalib::calib::ingest
