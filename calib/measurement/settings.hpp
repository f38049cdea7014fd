// Numbers that decide what is measured and which measurements count, each once, with its unit and its origin
// (see calib/matching/settings.hpp).
#pragma once

#include <array>
#include <cstddef>

namespace odomcalib::calib::measurement::settings {

// --- Adjust ----------------------------------------------------------------------------------------------

/// Rounds of robust weights. Chosen, sensitive.
inline constexpr int kAdjustRounds = 3;
/// Information of a wall that nobody strikes, relative to the largest. Chosen, sensitive.
inline constexpr double kWallPrior = 1e-6;

// --- Dataset ---------------------------------------------------------------------------------------------

/// Khepera-sized start for tuple files, which carry no nominal geometry; the closed form replaces it.
/// Chosen, sensitive.
inline constexpr double kUnknownRadius_m = 0.05;
/// m, track width of a robot that states none. Chosen, sensitive.
inline constexpr double kUnknownTrack_m = 0.3;
/// m, rad and s, between parameters with which scans need not be matched again. Chosen, insensitive.
inline constexpr double kSameParameters = 1e-4;

// --- Heading pairs ---------------------------------------------------------------------------------------

/// m, between the two sensors of a pair of scans. Chosen, insensitive.
inline constexpr double kNearSensors_m = 0.8;
/// s, between the scans of such a pair: odometry must still be a guess. Chosen, insensitive.
inline constexpr double kHeadingPair_s = 40.0;
/// m, of a beam from the wall that it is compared with. Chosen, insensitive.
inline constexpr double kHeadingGate_m = 0.08;
/// Cosine of the normals of both. Chosen: 14 degrees.
inline constexpr double kHeadingNormals = 0.97;
/// Cosine of the flattest beam. Chosen, insensitive.
inline constexpr double kHeadingIncidence = 0.3;
/// m, from the end of a wall: the reach of a local line. Derived from kReachOfLine_m.
inline constexpr double kHeadingMargin_m = 0.25;
/// rad, from a turn that is wanted between the scans of a pair. Chosen, insensitive.
inline constexpr double kTurnTolerance_rad = 0.3;
/// rad, wanted between the scans of a pair. Chosen, insensitive.
inline constexpr std::array kWantedTurns_rad = {2.4, 1.2, 3.0, 0.7, 1.8};
/// Readings to either side among which the beam nearest to a place is looked for. Chosen, insensitive.
inline constexpr std::size_t kBeamsBeside = 4;
/// Points of a pair. Chosen, insensitive.
inline constexpr std::size_t kFewestHeadingPoints = 40;

// --- Localise --------------------------------------------------------------------------------------------

/// Beams on walls from which a scan is placed. Chosen, sensitive.
inline constexpr std::size_t kFewestInliers = 40;
/// Inliers as a share of the beams that should strike a wall. Chosen, sensitive.
inline constexpr double kLeastInliers = 0.5;
/// Ratio of the information's least and largest eigenvalue, of a place that is determined. Chosen,
/// insensitive.
inline constexpr double kLeastEigenvalue = 0.01;
/// sigma. Chosen, sensitive.
inline constexpr double kPlaceSettled = 0.1;
/// Steps before they are halved. Chosen, sensitive.
inline constexpr int kWholeSteps = 5;
/// Share of the gate that is left after a step. Chosen, sensitive.
inline constexpr double kPlaceGateShrinks = 0.4;
/// m, and deviations of a range: the last gate, whichever is wider. Chosen, sensitive.
inline constexpr double kLastPlaceGate_m = 0.05, kLastPlaceGateSigmas = 6.0;
/// Steps. Chosen, insensitive.
inline constexpr int kMostPlaceSteps = 12;
/// m and rad, of a step so short that it leads few beams to another wall. Chosen, sensitive.
inline constexpr double kSameStrikes = 1e-3;

// --- Noise estimate --------------------------------------------------------------------------------------

/// Pairs whose likelihood is taken. Derived: their three residuals each give a deviation to 0.3 %, where the
/// search ends at 8 %.
inline constexpr std::size_t kMostNoisePairs = 20'000;
/// Sweeps over the parameters of the noise. Chosen, sensitive.
inline constexpr int kNoiseSweeps = 2;
/// Fall of -2 log L that one more parameter of the noise must bring. Derived: at the border of what is
/// possible half of the usual test's level, 5 % with 2.71 in place of 3.84.
inline constexpr double kNoisePresent = 2.71;
/// Standard deviations at which a residual is cut in the noise's likelihood. Chosen, sensitive.
inline constexpr double kWinsor = 2.5;
/// Degrees of freedom of the Student t distribution that stands for noise with outliers (failed matches,
/// bumps). Chosen, sensitive.
inline constexpr double kStudentDof = 4.0;
/// Factor on squared distances that makes the t likelihood read normally distributed noise at its true size.
/// Derived: the root f of E[(dof + 3) f q / (dof + f q)] = 3 for q ~ chi-squared with 3 degrees of freedom.
inline constexpr double kStudentConsistency = 1.3229464;
/// Bounds of the search: rad and m a pair, s, and the factor on the matcher's deviations. Chosen, sensitive.
inline constexpr double kLeastProcess = 1e-5, kMostProcess = 0.1;
inline constexpr double kLeastJitter_s = 2e-4, kMostJitter_s = 0.1;
inline constexpr double kLeastMatcherScale = 0.2, kMostMatcherScale = 1.5;
/// Width of the search's last interval, of a logarithm. Chosen: 8 %.
inline constexpr double kNoiseResolution = 0.08;
/// Bounds of the correlation of neighbouring pairs. Chosen, sensitive.
inline constexpr double kLeastCorrelation = -0.48, kMostCorrelation = 0.3;

// --- Pair builder ----------------------------------------------------------------------------------------

/// m, a scan match whose covariance is not recorded. Chosen, sensitive.
inline constexpr double kTupleNoise_m = 1e-3;
/// rad, the same. Chosen, sensitive.
inline constexpr double kTupleNoise_rad = 2e-3;
/// rad, of a measured motion: sensor and base turn alike modulo a whole turn only, and near half a turn noise
/// decides which way it was. Chosen: 160 degrees.
inline constexpr double kMostTurn_rad = 2.8;
/// m, of a mean; scan matching is no better. Chosen, insensitive.
inline constexpr double kGoodMatch_m = 5e-4;
/// m of travel, rad of rotation, or s, if the wheels turned at all: what makes the next keyframe. Chosen,
/// sensitive.
inline constexpr double kPairDistance_m = 0.15, kPairRotation_rad = 0.25, kPairDuration_s = 0.75;
/// m and rad, of wheels that turned. Chosen, sensitive.
inline constexpr double kTurnedAtAll = 1e-3;
/// The same of a pose reference, which does not drift and whose error does not grow with the baseline.
/// Chosen: the customary keyframe spacing.
inline constexpr double kPosePairDistance_m = 0.5, kPosePairRotation_rad = 0.5, kPosePairDuration_s = 10.0;
/// Share of the pairs of scans with a whole motion, below which those count, too, that leave one direction
/// open. Chosen: where most scans see walls all round, single walls add little.
inline constexpr double kFewWholePairs = 0.8;
/// m and rad, deviation of a guess that a match is held to where it leaves a direction open. Chosen: ten
/// times and more what a match errs by in the directions that walls determine, so that it does not bend
/// these.
inline constexpr double kHeldGuess_m = 0.1, kHeldGuess_rad = 0.1;
/// Times their expectation, that distances of a match scatter of which a part counts. Chosen: deviations
/// that grow with the scatter stand for as much; by more, surfaces were taken for each other.
inline constexpr double kMostScatterOfPart = 5.0;
/// Share of what the wheels say, that scans saw of a robot that stood while its wheels turned. Chosen as
/// classical's kHardlyMoved.
inline constexpr double kStoodShare = 0.15;
/// m, that wheels must have rolled to tell. Chosen: a third of a pair's.
inline constexpr double kStoodRolled_m = 0.05;
/// m, at which a turn counts as a way there. Chosen: half a usual track width.
inline constexpr double kStoodArm_m = 0.15;
/// Pairs in a row. Chosen: two last longer than any delay that is looked for, which one at a start does not.
inline constexpr std::size_t kStoodInARow = 2;
/// m, deviation of a motion along the direction that a match leaves open. Chosen: more than any guess errs.
inline constexpr double kOpenDirection_m = 1.0;
/// Share of the usable points that must find a partner. Chosen as matching's.
inline constexpr double kPairOverlap = 0.4;

// --- Placed poses ----------------------------------------------------------------------------------------

/// s, over which wheels err by less than a pose does. Chosen, sensitive.
inline constexpr double kWheelSpan_s = 0.1;
/// m and rad: nothing is measured better. Chosen, insensitive.
inline constexpr double kLeastPoseNoise = 1e-4;
/// m and rad, of poses whose noise does not show. Chosen, sensitive.
inline constexpr double kUnknownPoseNoise = 1e-3;

// --- Range error terms -----------------------------------------------------------------------------------

/// Standard deviations of an error of the ranges. Chosen, insensitive.
inline constexpr double kRangeErrorSigmas = 6.0;
/// m; surfaces of the room differ by as much. Chosen, insensitive.
inline constexpr double kLeastRangeError_m = 3e-3;
/// Most change of the offset, as a share of it, when the incidence is allowed to explain it. Chosen,
/// insensitive.
inline constexpr double kMostOffsetChange = 0.5;
/// m, where a slanted beam's error is judged, at 45 degrees. Chosen, insensitive.
inline constexpr double kUsualDistance_m = 4.0;

// --- Scan path -------------------------------------------------------------------------------------------

/// m, of travel after which a scan adds walls to the map. Chosen, sensitive.
inline constexpr double kNewWallsAfter_m = 0.3;
/// rad, the same of a turn. Chosen, sensitive.
inline constexpr double kNewWallsAfter_rad = 0.35;
/// Scans that the map is adjusted to. Chosen, sensitive.
inline constexpr std::size_t kMostAdjusted = 500;
/// Placed, about thirteen a second in five minutes. Chosen, sensitive.
inline constexpr std::size_t kMostScans = 4000;
/// Beams of all scans that are placed. Chosen: memory.
inline constexpr double kMostBeams = 1.5e6;
/// Walls of a map. Chosen, insensitive.
inline constexpr std::size_t kMostWalls = 300;
/// Scans of a path. Chosen, insensitive.
inline constexpr std::size_t kFewestScans = 50;
/// Share of the scans that may have no place. Chosen, insensitive.
inline constexpr double kMostLost = 0.1;
/// Range noise, across a wall that was taken for two. Chosen, insensitive.
inline constexpr double kDoubleWall = 2.0;
/// m, for a scan placed from the one before it. Chosen, sensitive.
inline constexpr double kFirstGate_m = 0.15;

// --- Wall map --------------------------------------------------------------------------------------------

/// m; shorter pieces may be curved. Chosen, insensitive.
inline constexpr double kShortestWall_m = 0.25;
/// m across, between pieces of one wall. Chosen, insensitive.
inline constexpr double kWallOffset_m = 0.06;
/// Cosine between their normals, 5.7 degrees. Chosen, sensitive.
inline constexpr double kWallNormals = 0.995;
/// Cosine between the normals of a wall and its double. Chosen, sensitive.
inline constexpr double kDoubleNormals = 0.9;
/// m, between pieces of one wall. Chosen, insensitive.
inline constexpr double kGapAlong_m = 0.5;
/// m, of a double beyond the end of its wall. Chosen, insensitive.
inline constexpr double kOverhang_m = 0.1;
/// m, a wall is longer than what counts of it: both its ends are cut. Chosen, sensitive.
inline constexpr double kShade_m = 0.03;

// --- Placed scan -----------------------------------------------------------------------------------------

/// s, to either side, within which a scan is carried to a time. Chosen, insensitive.
inline constexpr double kPlaceReach_s = 0.15;
/// s, to either side, of scans whose mean is taken. Chosen: over so much wheels err by less than a place
/// does.
inline constexpr double kMeanReach = 0.5;
/// Scans of a mean. Chosen, insensitive.
inline constexpr std::ptrdiff_t kFewestOfMean = 2;

// --- Reference motion ------------------------------------------------------------------------------------

/// s, of one motion of a first look. Chosen: long enough that noise of a match is small against it.
inline constexpr double kFirstLookStep_s = 0.5;

// --- Sweep motion ----------------------------------------------------------------------------------------

/// s, between the poses that a sweep is interpolated from. Chosen: an arc of 1 m/s and 2 rad/s leaves its
/// chord by 6e-6 m within it.
inline constexpr double kSweepSpacing_s = 5e-3;

}  // namespace odomcalib::calib::measurement::settings
