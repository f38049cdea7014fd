// Numbers that decide how fits begin and end and which pairs count, each once, with its unit and its origin
// (see calib/matching/settings.hpp).
#pragma once

#include <cstddef>

namespace odomcalib::calib::estimation::settings {

// --- Joint -----------------------------------------------------------------------------------------------

/// sigma of a standardised residual vector. Chosen.
inline constexpr double kOutlier = 5.0;
/// Noise and weights are settled over this many outer rounds. Chosen.
inline constexpr int kNoiseRounds = 3;
/// Sigma. Gauss-Newton's next step after one of this length is shorter by orders of magnitude. Chosen.
inline constexpr double kFitSettled = 1e-2;
/// All recordings of one call come from one robot and one lidar; with few pairs each, they share a noise
/// model. Chosen.
inline constexpr std::size_t kPairsForOwnNoise = 100;

// --- Path fit --------------------------------------------------------------------------------------------

/// Of noise and parameters. Chosen.
inline constexpr int kPathRounds = 3;
/// Gauss-Newton steps a round. Chosen.
inline constexpr int kPathSteps = 3;
/// Over the noise parameters. Chosen.
inline constexpr int kPathSweeps = 2;
/// Chi-square of three degrees of freedom: one in 7e5. Chosen.
inline constexpr double kPathOutlierSquared = 30.0;
/// m, even standing wheels are not ideal. Chosen.
inline constexpr double kLeastRolled_m = 1e-4;

// --- Start values ----------------------------------------------------------------------------------------

/// s, to either side, over which a delay is searched. Chosen.
inline constexpr double kDelayReach_s = 0.6;
/// s, of that search. Chosen.
inline constexpr double kDelayStep_s = 0.02;
/// A delay must reduce the robust misfit by this factor to be believed; otherwise zero is the better start.
/// Chosen.
inline constexpr double kBelievableDelay = 0.9;
/// Nearer to each other, delays of both halves are within reach of the fit from the delay of the whole, s.
/// Chosen.
inline constexpr double kClocksApart_s = 0.06;

}  // namespace odomcalib::calib::estimation::settings
