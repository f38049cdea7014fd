// Numbers by which models are compared on data that was not fitted, each once, with its unit and its origin
// (see calib/matching/settings.hpp).
#pragma once

#include <array>
#include <cstddef>

namespace odomcalib::calib::validation::settings {

// --- Parts of a recording that are left out or drawn together --------------------------------------------

/// s, of pairs that belong to one fold. Chosen, sensitive.
inline constexpr double kFoldBlock_s = 20.0;
/// s, of evaluation windows that are resampled together. Chosen, sensitive.
inline constexpr double kWindowBlock_s = 30.0;
/// Parts of a recording that are left out in turn. Published: five or ten, T. Hastie, R. Tibshirani, J.
/// Friedman: The Elements of Statistical Learning, 2nd edition, Springer 2009, section 7.10.
inline constexpr std::size_t kFolds = 5;

// --- Robustness ------------------------------------------------------------------------------------------

/// Standard deviations at which a whitened residual is cut, so that one bad match does not decide. Chosen,
/// sensitive.
inline constexpr double kClip = 3.5;
/// Robust weight from which a pair counts in evaluation windows and in pictures. Chosen, sensitive.
inline constexpr double kTrustedWeight = 0.3;

// --- Gain on held-out data -------------------------------------------------------------------------------

/// Deviations by which the logarithm of a ratio of errors must lie below zero where the interval does not
/// tell. Derived: 90 % quantile of the normal distribution, one side. The level is chosen.
inline constexpr double kPlainGain = 1.282;

// --- Comparisons of measurements and models (criterion.hpp) -----------------------------------------------

/// Product of the three ratios of bounded held-out RMS, after to before, of what is clearly better. Chosen: 5
/// % in all.
inline constexpr double kClearlyBetter = 0.95;
/// Ratio of held-out RMS, after to before, in any one component. Chosen: 5 % is left to chance.
inline constexpr double kToleratedRms = 1.05;
/// Standard deviations that chained matches drift from the places in the map. Measured: rooms with walls
/// enough mostly stay below 1.5 (docs/developer/the-mathematics.md).
inline constexpr double kSliding = 2.0;
/// m and rad, of the place of a reference's marker. Chosen: more than anybody measures with a tape.
inline constexpr double kNegligibleMounting_m = 5e-4, kNegligibleMounting_rad = 2e-3;
/// m and rad, largest standard deviations of a place that the motion determines. Chosen: ten times what is
/// negligible.
inline constexpr double kKnownMounting_m = 5e-3, kKnownMounting_rad = 2e-2;

// --- Drive error -----------------------------------------------------------------------------------------

/// Windows of a kind from which its error is reported. Chosen, sensitive.
inline constexpr std::size_t kFewestOfAKind = 4;
/// Blocks from which an error's interval is drawn. Derived: of three only ten different draws exist, of one
/// only itself.
inline constexpr std::size_t kFewestBlocks = 4;
/// m, ways over which the error of the position is followed. Chosen: what a block of 20 s can hold.
inline constexpr std::array kWays_m = {0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0};

// --- Evaluation window -----------------------------------------------------------------------------------

/// s, of open-loop driving. Chosen, sensitive.
inline constexpr double kHorizon_s = 10.0;
/// rad/m, of a motion that counts as straight; more is a curve. Chosen, insensitive.
inline constexpr double kStraightest = 0.15;
/// m/rad, of a motion that counts as a turn on the spot; more is an arc. Chosen, sensitive.
inline constexpr double kOnTheSpot = 0.08;
/// m and rad; a pair at rest belongs to any kind. Chosen, sensitive.
inline constexpr double kStanding = 0.004;
/// m; on less, noise of the reference dominates. Chosen, sensitive.
inline constexpr double kShortestStraight_m = 0.25;
/// rad, of a turn that is judged. Chosen, sensitive.
inline constexpr double kSmallestTurn_rad = 0.6;

// --- Held out --------------------------------------------------------------------------------------------

/// Pairs from which a held-out residual is stated. Chosen, insensitive.
inline constexpr std::size_t kFewestHeldOut = 50;
/// sigma; a failed match says nothing about the wheels. Chosen, sensitive.
inline constexpr double kGrossError = 6.0;

// --- Quantiles -------------------------------------------------------------------------------------------

/// 95 % quantile of the normal distribution, both sides. Derived.
inline constexpr double kNormal95 = 1.960;

// --- Window errors ---------------------------------------------------------------------------------------

/// m, of travel over which an error of the heading counts as one of the position. Chosen, sensitive.
inline constexpr double kHeadingLever_m = 0.5;

}  // namespace odomcalib::calib::validation::settings
