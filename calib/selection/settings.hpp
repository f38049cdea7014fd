// Numbers that decide what is added to the model, each once, with its unit and its origin. An origin is one
// of: derived (from what), published (source), measured (where), chosen (for the reason that is given; where
// none is given, no comparison with other values is known).
#pragma once

#include <cstddef>

namespace odomcalib::calib::selection::settings {

// --- Parts of a recording that are drawn, left out or given a sign together --------------------------------

/// s, of pairs that get one sign in the score test. Chosen.
inline constexpr double kScoreBlock_s = 5.0;
/// s, of pairs whose held-out gain is resampled together. Chosen.
inline constexpr double kGainBlock_s = 10.0;
/// s, of pairs that belong to one fold. Chosen.
inline constexpr double kFoldBlock_s = 20.0;
/// s, of evaluation windows that are resampled together. Chosen.
inline constexpr double kWindowBlock_s = 30.0;
/// Parts of a recording that are left out in turn. Chosen.
inline constexpr std::size_t kFolds = 5;

// --- Robustness ------------------------------------------------------------------------------------------

/// Standard deviations at which a whitened residual is cut, so that one bad match does not decide. Chosen.
inline constexpr double kClip = 3.5;
/// Robust weight from which a pair counts in evaluation windows and in pictures. Chosen.
inline constexpr double kTrustedWeight = 0.3;

// --- Significance ----------------------------------------------------------------------------------------

/// Random draws of signs; the finest family-wise p-value is 1 / (1 + draws). Chosen.
inline constexpr int kSignDraws = 1999;
/// Bonferroni's bound below which no draws are needed. Chosen: far below any level used.
inline constexpr double kDecisive = 1e-12;
/// Family-wise level of named effects, and of smooth terms that must be worthwhile. Chosen: a nominal 1 %
/// test exceeds 1 % of robots in many campaigns. With kSignDraws no draw may be above.
inline constexpr double kNamedLevel = 0.0009;
/// Family-wise level of any other smooth term. Chosen; with kSignDraws at most four draws may be above.
inline constexpr double kUnnamedLevel = 0.0025;
/// Family-wise level of clock effects. Chosen: a delay hardly shows in odometry and cannot spoil it.
inline constexpr double kClockLevel = 0.003;
/// Family-wise level at which the data outside a fold must point to a candidate that all data have chosen.
/// Chosen.
inline constexpr double kFoldLevel = 0.05;

// --- Gain on held-out data -------------------------------------------------------------------------------

/// Largest share of the open-loop error that a candidate may leave where scan matching, or the place in a
/// scripted drive, has a bias of its own. Chosen: less is not worth a model.
inline constexpr double kWorthwhile = 0.95;
/// The same for any other smooth term that odometry uses. Chosen.
inline constexpr double kUseful = 0.97;
/// Ratio of errors above which, beyond its 95 % interval, a recording is spoilt. Chosen.
inline constexpr double kTolerated = 1.05;
/// Evaluation windows; fewer say nothing. Chosen.
inline constexpr std::size_t kFewestWindows = 10;
/// Share of the squared open-loop error beyond noise that smooth terms without a name must explain together.
/// Derived: what explains less leaves more unexplained than it explains.
inline constexpr double kLeastExplained = 0.5;

// --- Comparisons of measurements and models (criterion.hpp) -----------------------------------------------

/// Product of the three ratios of bounded held-out RMS, after to before, of what is clearly better. Chosen: 5
/// % in all.
inline constexpr double kClearlyBetter = 0.95;
/// Ratio of held-out RMS, after to before, in any one component. Chosen: 5 % is left to chance.
inline constexpr double kToleratedRms = 1.05;
/// Standard deviations from zero of an estimate that is present. Chosen: of normal errors 6 in 100 000 are
/// larger.
inline constexpr double kSignificance = 4.0;
/// Standard deviations of the difference within which two estimates agree. Chosen as kSignificance.
inline constexpr double kAgreement = 4.0;
/// Standard deviations that chained matches drift from the places in the map. Measured: rooms with walls
/// enough mostly stay below 1.5 (docs/developer/the-mathematics.md).
inline constexpr double kSliding = 2.0;
/// s, of a time offset that is negligible. Chosen: what a careful driver leaves.
inline constexpr double kNegligibleOffset_s = 3e-3;
/// m and rad, of the place of a reference's marker. Chosen: more than anybody measures with a tape.
inline constexpr double kNegligibleSeat_m = 5e-4, kNegligibleSeat_rad = 2e-3;
/// m and rad, largest standard deviations of a place that the motion determines. Chosen: ten times what is
/// negligible.
inline constexpr double kKnownSeat_m = 5e-3, kKnownSeat_rad = 2e-2;

}  // namespace odomcalib::calib::selection::settings
