// Streams whose numbers cannot be seconds, radians or metres: which unit they look like, and what to write
// instead. Asked before anything is measured, since matching drops what does not fit and forgets why.
#pragma once

#include <optional>
#include <string>

#include "proto/recording/recording.hpp"

namespace odomcalib::calib::ingest {

/// Unit in which an interval between samples would be a usual one: "milliseconds", "microseconds",
/// "nanoseconds", "minutes"; empty where it is usual in seconds or in none of these.
/// @param interval median of neighbouring stamps, in the unit of the recording
std::string unit_of_interval(double interval);

/// The first stream that cannot be what it is called; nullopt when all may be. Error: format.
std::optional<Error> wrong_units(const Recording& recording);

}  // namespace odomcalib::calib::ingest
