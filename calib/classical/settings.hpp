// Numbers that decide which factor a length has in it, each once, with its unit and its origin: derived (from
// what), published (source), measured (where), chosen (for what reason).
#pragma once

namespace odomcalib::calib::classical::settings {

/// Ratio of an estimated and a nominal length that still is a measurement of the same thing, and its inverse.
/// Chosen: beyond the 10 % that the gate warns of, below the smallest factor of the table (1.5).
inline constexpr double kSameLength = 1.2;
/// Relative deviation of a ratio from a factor of the table, and of ratios that are alike. Derived: nominal
/// values are right to 10 %, and neighbouring factors of the table are 27 % apart at least.
inline constexpr double kSameFactor = 0.12;

}  // namespace odomcalib::calib::classical::settings
