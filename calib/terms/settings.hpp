// Numbers that decide which terms are candidates and in which bases, each once, with its unit and its origin
// (see calib/matching/settings.hpp).
#pragma once

#include <array>
#include <cstddef>

namespace odomcalib::calib::terms::settings {

// --- Candidate smooths -----------------------------------------------------------------------------------

/// Relay is tried: the others are found by their neighbours. Chosen, insensitive.
inline constexpr std::size_t kEveryRelay = 3;
/// Poles of encoder magnets, lugs, spokes. Chosen, insensitive.
inline constexpr int kHighestHarmonic = 8;
/// s, of what repeats itself in time. Chosen, insensitive.
inline constexpr double kShortestCycle_s = 8.0;
/// Cycles within the drive. Chosen, insensitive.
inline constexpr double kFewestCycles = 1.5;
/// Cycles between two that are tried. Chosen, insensitive.
inline constexpr double kCycleStep = 0.7;
/// Cycles within the drive. What repeats itself more often is proposed by a periodogram instead of being
/// tried one by one, which would grow with the square of the duration. Chosen: sixteen minutes' of the
/// shortest.
inline constexpr double kMostCycles = 120.0;
/// Parts of the drive before and after a change point. Chosen, insensitive.
inline constexpr int kLeastPart = 2;
/// Halvings of the step between change points, of the moments tried about the one that was found. Chosen,
/// sensitive.
inline constexpr int kFirstHalving = 3, kLastHalving = 5;
/// s, of a lidar's metre that fades. Chosen: warming up is a matter of minutes.
inline constexpr std::array kFadingTimes_s = {30.0, 100.0};
/// Factors on the time constant that was found, which are tried. Chosen, sensitive.
inline constexpr std::array kFadingFactors = {0.5, 0.71, 1.41, 2.0};

// --- Lidar smooth term -----------------------------------------------------------------------------------

/// m, of a range, that is expected of a smooth term. Chosen, insensitive.
inline constexpr double kSmallShift_m = 3e-3;
/// rad, of a bearing, that is expected. Chosen, insensitive.
inline constexpr double kSmallAngle_rad = 2e-3;
/// m, largest shift that a lidar may have. Chosen, insensitive.
inline constexpr double kLargestShift_m = 0.2;
/// rad, largest. Chosen, insensitive.
inline constexpr double kLargestAngle_rad = 0.1;
/// Points of a wall that a term of the ranges is fitted to. Chosen, insensitive.
inline constexpr std::size_t kFewestReadings = 30;
/// Knots over the bearings of a turn. Chosen: 15 degrees apart.
inline constexpr std::size_t kBearingKnots = 24;
/// Knots over the ranges, m of the first; each of the others lies at twice the one before. Chosen,
/// insensitive.
inline constexpr std::size_t kRangeKnots = 4;
inline constexpr double kNearestRange_m = 0.5;

// --- Periodic smooths ------------------------------------------------------------------------------------

/// m, of what repeats itself along the floor. Chosen, insensitive.
inline constexpr double kShortestWave_m = 0.2;
/// m; what changes slower is left to the polynomials. Chosen, insensitive.
inline constexpr double kLongestWave_m = 1.25;
/// Cycles over the place's extent. Chosen, insensitive.
inline constexpr double kWaveStep = 0.7;
/// m, least extent taken for separating waves. Chosen, insensitive.
inline constexpr double kSmallestPlace_m = 0.5;
/// The shortest are left out where there would be more. Chosen, insensitive.
inline constexpr double kMostWaves = 1500;

// --- Smooth term on drives -------------------------------------------------------------------------------

/// m/s of either wheel; standing still shows nothing. Chosen, insensitive.
inline constexpr double kMoving = 0.01;
/// Share of the way that a drive must go the other way to count as one both ways. Chosen, insensitive.
inline constexpr double kLeastOfWay = 0.2;

// --- Fading since an event -------------------------------------------------------------------------------

/// m of the base, and rad of a wheel: the nearest knot. Chosen, insensitive.
inline constexpr double kNearestKnot_m = 0.03, kNearestKnot_rad = 0.2;

}  // namespace odomcalib::calib::terms::settings
