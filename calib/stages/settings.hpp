// Numbers by which a fit is refined before and after the search, each once, with its unit and its origin (see
// calib/matching/settings.hpp).
#pragma once

#include <cstddef>

namespace odomcalib::calib::stages::settings {

// --- Clocks ----------------------------------------------------------------------------------------------

/// s, of a time offset that is negligible. Chosen: what a careful driver leaves.
inline constexpr double kNegligibleOffset_s = 3e-3;

// --- Lidar -----------------------------------------------------------------------------------------------

/// Pairs of scans with other headings, of all recordings together. Chosen, insensitive.
inline constexpr std::size_t kMostHeadingPairs = 120;

}  // namespace odomcalib::calib::stages::settings
