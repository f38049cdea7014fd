// Numbers that decide which factor a length has in it, and which moves show a length, each once, with its
// unit and its origin: derived (from what), published (source), measured (where), chosen (for what reason).
#pragma once

#include "calib/math/se2.hpp"

namespace odomcalib::calib::classical::settings {

/// Ratio of an estimated and a nominal length that still is a measurement of the same thing, and its inverse.
/// Chosen: beyond the 10 % that the gate warns of, below the smallest factor of the table (1.5).
inline constexpr double kSameLength = 1.2;
/// Relative deviation of a ratio from a factor of the table, and of ratios that are alike. Derived: nominal
/// values are right to 10 %, and neighbouring factors of the table are 27 % apart at least.
inline constexpr double kSameFactor = 0.12;

// --- Straight and spin -----------------------------------------------------------------------------------

/// rad, by which a stretch may turn that still counts as straight. Chosen.
inline constexpr double kStraightYaw_rad = 0.02;
/// m in all, of straight motion that shows a diameter. Chosen.
inline constexpr double kLeastTravel_m = 0.3;

// --- Rest to rest ----------------------------------------------------------------------------------------

/// m, of a straight move. Chosen: below it errors at rest weigh too much.
inline constexpr double kLeastDistance_m = 0.2;
/// rad, by which a straight move may turn. Chosen.
inline constexpr double kMostYaw_rad = 0.5;
/// rad, of a turn on the spot. Chosen: a quarter of a turn.
inline constexpr double kLeastTurn_rad = math::kPi / 2.0;
/// Share of a side; a drive that ends farther from its start is no square. Chosen.
inline constexpr double kFarEnd = 0.5;

}  // namespace odomcalib::calib::classical::settings
