// Numbers that decide how two scans are matched for callers outside calibration, each once, with its unit and
// its origin (see calib/matching/settings.hpp).
#pragma once

#include <cstddef>

namespace odomcalib::calib::settings {

/// Overlap above which no better pose is looked for. Chosen, insensitive.
inline constexpr double kConvincing = 0.8;
/// Points of the scan that is searched for. Chosen: more add little on cells of 10 cm.
inline constexpr std::size_t kSearchPoints = 150;
/// Points that a score says something about. Chosen, insensitive.
inline constexpr std::size_t kFewestScored = 10;

}  // namespace odomcalib::calib::settings
