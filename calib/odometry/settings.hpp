// Numbers that decide how a calibration is applied to counts, each once, with its unit and its origin (see
// calib/matching/settings.hpp).
#pragma once

#include <cstddef>

namespace odomcalib::calib::odometry::settings {

/// s, between the first stamps of drives that both begin at zero. Chosen, insensitive.
inline constexpr double kTogether_s = 1.0;
/// Times the duration of the drive, after its begin, up to which a stamp belongs to it. Chosen, insensitive.
inline constexpr double kAfterTheDrive = 2.0;
/// Samples that are kept: effects see speeds, and speeds need a little history. Chosen, insensitive.
inline constexpr std::size_t kHistory = 32;

}  // namespace odomcalib::calib::odometry::settings
