// Numbers that decide which samples the library takes in, each once, with its unit and its origin (see
// calib/matching/settings.hpp).
#pragma once

#include <cstdint>

namespace odomcalib::calib::library::settings {

/// m/s; no robot that is calibrated with this program drives faster. Chosen as in
/// proto/recording/tick_counts.cpp, where recordings are judged by it.
inline constexpr double kFastest = 10.0;
/// s between samples, until some have come. Chosen, untried.
inline constexpr double kUsualInterval_s = 0.1;
/// s; longer ones are pauses and say nothing of how often samples come. Chosen, untried.
inline constexpr double kLongestInterval_s = 1.0;
/// Share of a new interval in the mean of the last ones: jittering stamps make short ones, and two samples
/// that a bus hands over at once are no jump. Chosen, untried.
inline constexpr double kShareOfInterval = 1.0 / 16.0;
/// Derived: beyond it a count is no exact double.
inline constexpr std::int64_t kMostCounts = std::int64_t{1} << 53;

}  // namespace odomcalib::calib::library::settings
