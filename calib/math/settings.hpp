// Numbers that decide which errors are taken for independent and how intervals are drawn, each once, with its
// unit and its origin (see calib/matching/settings.hpp).
#pragma once

namespace odomcalib::calib::math::settings {

// --- Significance ------------------------------------------------------------------------------------------

/// Standard deviations beyond which an estimate is not zero, and two estimates are not the same. Chosen: of
/// normal errors 6 in 100 000 are larger.
inline constexpr double kClearSigmas = 4.0;

// --- Scatter of blocks -----------------------------------------------------------------------------------

/// s, of measurements whose errors may depend on each other: the scatter of a model's parameters, the signs
/// of the score test, the gain on held-out data. Chosen, sensitive.
inline constexpr double kBlock_s = 5.0;
/// Blocks whose scatter still means something. Chosen, insensitive.
inline constexpr double kFewestScattered = 12.0;
/// Probability that longer blocks are believed where errors do not drift. Chosen, insensitive.
inline constexpr double kLongerByChance = 1e-3;

// --- Bootstrap --------------------------------------------------------------------------------------------

/// Draws with replacement. Chosen, sensitive.
inline constexpr int kBootstrapDraws = 1000;

}  // namespace odomcalib::calib::math::settings
