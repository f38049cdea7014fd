// Numbers that decide how counts become wheel angles, each once, with its unit and its origin (see
// calib/matching/settings.hpp).
#pragma once

#include <cstdint>

namespace odomcalib::calib::wheels::settings {

// --- Fine track ------------------------------------------------------------------------------------------

/// s, longest interval of samples between which angles are interpolated by cubics. Chosen, sensitive.
inline constexpr double kFineInterval_s = 0.03;
/// s, of a gap across which nothing is interpolated. Chosen, insensitive.
inline constexpr double kGap_s = 0.5;

// --- Rest ------------------------------------------------------------------------------------------------

/// Counts that differ by no more are those of a wheel that stands. Derived: it may rest under an edge of the
/// encoder at either end.
inline constexpr std::int64_t kStandingCounts = 2;

// --- Wheel track -----------------------------------------------------------------------------------------

/// Neighbours' durations. Chosen, sensitive.
inline constexpr double kSimilarIntervals = 2.0;

}  // namespace odomcalib::calib::wheels::settings
