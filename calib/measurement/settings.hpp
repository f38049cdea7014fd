// Numbers that decide what is measured and which measurements count, each once, with its unit and its origin
// (see calib/matching/settings.hpp).
#pragma once

#include <cstddef>

namespace odomcalib::calib::measurement::settings {

// --- Adjust ----------------------------------------------------------------------------------------------

/// Rounds of robust weights. Chosen.
inline constexpr int kAdjustRounds = 3;

// --- Dataset ---------------------------------------------------------------------------------------------

/// Khepera-sized start for tuple files, which carry no nominal geometry; the closed form replaces it.
/// Chosen.
inline constexpr double kUnknownRadius_m = 0.05;
/// m, track width of a robot that states none. Chosen.
inline constexpr double kUnknownTrack_m = 0.3;

// --- Heading pairs ---------------------------------------------------------------------------------------

/// m, between the two sensors of a pair of scans. Chosen.
inline constexpr double kNearSensors_m = 0.8;
/// s, between the scans of such a pair: odometry must still be a guess. Chosen.
inline constexpr double kHeadingPair_s = 40.0;
/// m, of a beam from the wall that it is compared with. Chosen.
inline constexpr double kHeadingGate_m = 0.08;
/// Cosine of the normals of both. Chosen: 14 degrees.
inline constexpr double kHeadingNormals = 0.97;
/// Cosine of the flattest beam. Chosen.
inline constexpr double kHeadingIncidence = 0.3;
/// m, from the end of a wall: the reach of a local line. Derived from kReachOfLine_m.
inline constexpr double kHeadingMargin_m = 0.25;
/// rad, from a turn that is wanted between the scans of a pair. Chosen.
inline constexpr double kTurnTolerance_rad = 0.3;

// --- Localise --------------------------------------------------------------------------------------------

/// Beams on walls from which a scan is placed. Chosen.
inline constexpr std::size_t kFewestInliers = 40;
/// Of the beams that should strike a wall. Chosen.
inline constexpr double kLeastInliers = 0.5;
/// Ratio of the information's least and largest eigenvalue, of a place that is determined. Chosen.
inline constexpr double kLeastEigenvalue = 0.01;
/// sigma. Chosen.
inline constexpr double kPlaceSettled = 0.1;
/// Steps before they are halved. Chosen.
inline constexpr int kWholeSteps = 5;

// --- Noise estimate --------------------------------------------------------------------------------------

/// Sweeps over the parameters of the noise. Chosen.
inline constexpr int kNoiseSweeps = 2;
/// Standard deviations at which a residual is cut in the noise's likelihood. Chosen.
inline constexpr double kWinsor = 2.5;

// --- Pair builder ----------------------------------------------------------------------------------------

/// m, a scan match whose covariance is not recorded. Chosen.
inline constexpr double kTupleNoise_m = 1e-3;
/// rad, the same. Chosen.
inline constexpr double kTupleNoise_rad = 2e-3;
/// rad, of a measured motion: sensor and base turn alike modulo a whole turn only, and near half a turn noise
/// decides which way it was. Chosen: 160 degrees.
inline constexpr double kMostTurn_rad = 2.8;
/// m, of a mean; scan matching is no better. Chosen.
inline constexpr double kGoodMatch_m = 5e-4;

// --- Placed poses ----------------------------------------------------------------------------------------

/// s, over which wheels err by less than a pose does. Chosen.
inline constexpr double kWheelSpan_s = 0.1;
/// m and rad: nothing is measured better. Chosen.
inline constexpr double kLeastPoseNoise = 1e-4;
/// m and rad, of poses whose noise does not show. Chosen.
inline constexpr double kUnknownPoseNoise = 1e-3;

// --- Range error terms -----------------------------------------------------------------------------------

/// Standard deviations of an error of the ranges. Chosen.
inline constexpr double kRangeErrorSigmas = 6.0;
/// m; surfaces of the room differ by as much. Chosen.
inline constexpr double kLeastRangeError_m = 3e-3;
/// Of the offset, when the incidence is allowed to explain it. Chosen.
inline constexpr double kMostOffsetChange = 0.5;
/// m, where a slanted beam's error is judged, at 45 degrees. Chosen.
inline constexpr double kUsualDistance_m = 4.0;

// --- Scan path -------------------------------------------------------------------------------------------

/// m, of travel after which a scan adds walls to the map. Chosen.
inline constexpr double kNewWallsAfter_m = 0.3;
/// rad, the same of a turn. Chosen.
inline constexpr double kNewWallsAfter_rad = 0.35;
/// Scans that the map is adjusted to. Chosen.
inline constexpr std::size_t kMostAdjusted = 500;
/// Placed, about thirteen a second in five minutes. Chosen.
inline constexpr std::size_t kMostScans = 4000;
/// Beams of all scans that are placed. Chosen: memory.
inline constexpr double kMostBeams = 1.5e6;
/// Walls of a map. Chosen.
inline constexpr std::size_t kMostWalls = 300;
/// Scans of a path. Chosen.
inline constexpr std::size_t kFewestScans = 50;
/// Share of the scans that may have no place. Chosen.
inline constexpr double kMostLost = 0.1;
/// Range noise, across a wall that was taken for two. Chosen.
inline constexpr double kDoubleWall = 2.0;
/// m, for a scan placed from the one before it. Chosen.
inline constexpr double kFirstGate_m = 0.15;

// --- Wall map --------------------------------------------------------------------------------------------

/// m; shorter pieces may be curved. Chosen.
inline constexpr double kShortestWall_m = 0.25;
/// m across, between pieces of one wall. Chosen.
inline constexpr double kWallOffset_m = 0.06;
/// Cosine between their normals, 5.7 degrees. Chosen.
inline constexpr double kWallNormals = 0.995;
/// Cosine between the normals of a wall and its double. Chosen.
inline constexpr double kDoubleNormals = 0.9;
/// m, between pieces of one wall. Chosen.
inline constexpr double kGapAlong_m = 0.5;
/// m, of a double beyond the end of its wall. Chosen.
inline constexpr double kOverhang_m = 0.1;
/// m, a wall is longer than what counts of it: both its ends are cut. Chosen.
inline constexpr double kShade_m = 0.03;

}  // namespace odomcalib::calib::measurement::settings
