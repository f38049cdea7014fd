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

/// Each: why a stream cannot be what it is called; nullopt where it may be. Error: format.
std::optional<Error> scans_too_fast(const Recording& recording);  ///< for any head
std::optional<Error> spans_in_units(const Recording& recording);  ///< of the times of counts and reference
std::optional<Error> slow_beams(const Recording& recording);  ///< a scan that takes longer than to the next
std::optional<Error> too_many_turns(const Recording& recording);    ///< that one scan covers
std::optional<Error> wrong_ranges(const Recording& recording);      ///< that no 2D lidar reads in metres
std::optional<Error> wrong_lidar_pose(const Recording& recording);  ///< no place on a robot, and no angle

}  // namespace odomcalib::calib::ingest
