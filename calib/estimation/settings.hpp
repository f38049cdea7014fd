// Numbers that decide how fits begin and end, which pairs count and what a first look names, each once, with
// its unit and its origin (see calib/matching/settings.hpp).
#pragma once

#include <array>
#include <cstddef>

#include "calib/math/se2.hpp"

namespace odomcalib::calib::estimation::settings {

// --- First look ------------------------------------------------------------------------------------------

/// Scans or poses that are looked at. Chosen: half a minute to ten minutes, by the reference's rate.
inline constexpr std::size_t kMostLookedAt = 3000;
/// The same while each of several mistakes is tried on the scans. Chosen: a minute at 10 Hz.
inline constexpr std::size_t kMostTried = 600;
/// Motions of half a second that a judgement takes. Chosen, insensitive.
inline constexpr std::size_t kFewestMotions = 20;
/// Share of the reference's rotation that the counts explain: below the first they contradict it, above the
/// second they agree. Measured: sound simulated recordings have 0.93 to 0.99, clocks apart by seconds 0 to
/// 0.4.
inline constexpr double kContradicts = 0.75, kAgrees = 0.9;
/// Share of unexplained rotation that a mistake put right may leave. Chosen: no small gain names a mistake.
inline constexpr double kLeftOver = 0.4;
/// Part of the distance from the axle by which turns on the spot and the lidar may differ. Chosen: the closed
/// form of a first look knows the lidar's y to a centimetre or two, its nominal y is measured with a tape.
inline constexpr double kSameBeside = 0.5;
/// m, of a motion of half a second whose direction is known. Chosen: matches are good to some mm.
inline constexpr double kPlainWay_m = 0.02;
/// Share of the way that goes sideways, of a robot that strafes. Measured: 0.44 where mecanum wheels strafe
/// for a part of the drive, 0.23 on two wheels where matches are poor (MaeBot a0).
inline constexpr double kStrafes = 0.33;
/// s, step and reach of the search for clocks that were set apart. Chosen: people start recorders within a
/// minute of each other.
inline constexpr double kClockStep_s = 0.1, kClockReach_s = 60.0;
/// Relative difference of the lengths of two streams that may be one of their clocks' rates. Chosen,
/// insensitive.
inline constexpr double kSpansApart = 0.05;
/// Counts that a wheel may fall by and still count up only. Derived: an edge seen twice.
inline constexpr int kEdge = 2;
/// Such motions at least. Chosen: one match in a hundred fails.
inline constexpr std::size_t kFewestAgainstCounting = 5;
/// Share of the motions in which counts with a direction explain the rotation plainly better, of counts that
/// have none. Chosen: now and then a match fails.
inline constexpr double kAgainstCounting = 0.05;
/// rad in half a second, by which a motion contradicts the counts, and the share of that which may be left
/// with a direction. Chosen: no match is off by the first.
inline constexpr double kContradicting_rad = 0.1, kLeftWithDirection = 0.3;
/// m, nearly straight on in all, that show the unit of odometry. Chosen, insensitive.
inline constexpr double kStraightOn_m = 0.5;
/// rad, turned in all, after which left and right counts cannot be the same. Chosen, insensitive.
inline constexpr double kTurned_rad = 1.0;
/// Ratio of a length to its nominal value, less one. Chosen: nominal values are right to that.
inline constexpr double kNearNominal = 0.1;
/// Ratios of the angles that a scan was sent with to those that are stated, which are tried. Chosen,
/// sensitive.
inline constexpr std::array kAngleFactors = {0.75, 4.0 / 3.0, 0.5, 2.0, 2.0 / 3.0, 1.5};
/// Rounds of bounded residuals. Chosen, insensitive.
inline constexpr int kGainRounds = 4;

// --- Joint -----------------------------------------------------------------------------------------------

/// sigma of a standardised residual vector. Chosen, sensitive.
inline constexpr double kOutlier = 5.0;
/// Noise and weights are settled over this many outer rounds. Chosen, sensitive.
inline constexpr int kNoiseRounds = 3;
/// Gauss-Newton steps of a fit, all outer rounds together. Chosen, insensitive.
inline constexpr int kMostJointIterations = 60;
/// Sigma. Gauss-Newton's next step after one of this length is shorter by orders of magnitude. Chosen,
/// sensitive.
inline constexpr double kFitSettled = 1e-2;
/// All recordings of one call come from one robot and one lidar; with few pairs each, they share a noise
/// model. Chosen, insensitive.
inline constexpr std::size_t kPairsForOwnNoise = 100;
/// Sigma that parameters may move before the model is linearised anew. Chosen, sensitive.
inline constexpr double kLinearReach = 1.0;
/// Steps that are tried, each ten times as damped as the one before. Chosen, insensitive.
inline constexpr int kMostDampings = 8;
/// Component of a direction without information, from which a parameter is named. Chosen, insensitive.
inline constexpr double kNamedComponent = 0.3;

// --- Path fit --------------------------------------------------------------------------------------------

/// Rounds of noise and parameters. Chosen, sensitive.
inline constexpr int kPathRounds = 3;
/// Gauss-Newton steps a round. Chosen, sensitive.
inline constexpr int kPathSteps = 3;
/// Over the noise parameters. Chosen, sensitive.
inline constexpr int kPathSweeps = 2;
/// Chi-square of three degrees of freedom: one in 7e5. Chosen, sensitive.
inline constexpr double kPathOutlierSquared = 30.0;
/// m, even standing wheels are not ideal. Chosen, sensitive.
inline constexpr double kLeastRolled_m = 1e-4;
/// Motions between placed scans that a fit takes. Chosen, insensitive.
inline constexpr std::size_t kFewestLinks = 50;
/// Bits to which the logarithm of a noise is searched. Chosen: about a hundredth of its range.
inline constexpr int kPathNoiseBits = 7;
/// Bounds of the search: factor on the places' deviations, the wheels' noise in m or rad per root of a metre,
/// and s. Chosen, sensitive.
inline constexpr double kLeastPlaceScale = 0.3, kMostPlaceScale = 4.0;
inline constexpr double kLeastPathNoise = 1e-5, kMostPathNoise = 0.1;
inline constexpr double kLeastPathJitter_s = 1e-5, kMostPathJitter_s = 0.05;
/// m and rad per root of a metre, with which that search begins. Chosen, sensitive.
inline constexpr double kStartPathNoise_m = 2e-4, kStartPathNoise_rad = 1e-3;

// --- Start values ----------------------------------------------------------------------------------------

/// s, to either side, over which a delay is searched. Chosen, insensitive.
inline constexpr double kDelayReach_s = 0.6;
/// s, of that search. Chosen, insensitive.
inline constexpr double kDelayStep_s = 0.02;
/// A delay must reduce the robust misfit by this factor to be believed; otherwise zero is the better start.
/// Chosen, sensitive.
inline constexpr double kBelievableDelay = 0.9;
/// Nearer to each other, delays of both halves are within reach of the fit from the delay of the whole, s.
/// Chosen, insensitive.
inline constexpr double kClocksApart_s = 0.06;
/// Rounds of one reweighting each. Chosen, insensitive.
inline constexpr int kMisfitRounds = 3;
/// rad, from its nominal value, of a lidar that looks to the other side. Derived: a right angle, beyond which
/// the fit's way to negative lengths is the shorter one.
inline constexpr double kOtherSide_rad = 0.5 * math::kPi;
/// s/s, of two clocks that drift apart. Chosen as kSpansApart: beyond it, halves of few pairs found each its
/// own delay.
inline constexpr double kMostClockRate = 0.05;

// --- Clock that is set -----------------------------------------------------------------------------------

/// s, to either side, over which the delays before and after are searched, and step of that. Chosen: larger
/// steps leave a gap that says the same.
inline constexpr double kSplitReach_s = 2.0, kSplitStep_s = 0.02;
/// s, step with which both are found in the end. Chosen: a tenth of the coarse one.
inline constexpr double kFineSplitStep_s = 0.002;
/// Pairs on either side. Chosen: some ten seconds.
inline constexpr std::size_t kFewestPairsOfClock = 12;
/// rad, noise of a measured rotation, at least. Chosen, insensitive.
inline constexpr double kLeastTurnNoise_rad = 1e-3;
/// Square of the sigmas beyond which a pair says nothing. Chosen: three.
inline constexpr double kGrossTurnSquared = 9.0;
/// Chi-square by which two delays must explain more than one, and more than one that grows. Derived: of some
/// 100 moments and 200 by 200 delays by chance one gains 2 ln(4e6) = 30; twice that, and half of it against a
/// drift.
inline constexpr double kPlainSplit = 60.0, kSplitNotDrift = 30.0;
/// Rounds of splitting and of finding the gains. Chosen, insensitive.
inline constexpr int kSplitRounds = 3;
/// s, about the first pair after the step, in which the step shows in the stamps. Chosen: two pairs.
inline constexpr double kMomentReach_s = 2.0;
/// Part of a step, at least, by which the interval of the stamps across it is unlike the others. Chosen:
/// half; stamps of the other clock do not step.
inline constexpr double kShownPart = 0.5;
/// s, and times the usual interval, of a gap that a clock may have made that was set ahead. Chosen: the
/// search above finds smaller steps, and samples get lost now and then.
inline constexpr double kLeastLeap_s = 1.5, kLeapIntervals = 5.0;
/// s, from the begin of such a gap, in which the other stream must go on, and share of its usual samples
/// then. Chosen: half of what comes in two seconds.
inline constexpr double kLongestLook_s = 2.0, kGoesOn = 0.5;
/// Gaps of one recording that are tried. Chosen: more are lost samples; each trial matches a minute of scans.
inline constexpr std::size_t kMostLeaps = 6;

// --- Gyro witness ----------------------------------------------------------------------------------------

/// Relative deviation of the scale of a MEMS gyro. Published: +-3 % (MPU-6050, product specification).
inline constexpr double kGyroScale = 0.03;
/// rad/s, deviation of a gyro's bias before anything is known. Chosen; the same specification states +-20
/// deg/s.
inline constexpr double kGyroBias = 0.1;
/// s, deviation of a gyro's clock about the best of the coarse search. Chosen, sensitive.
inline constexpr double kGyroOffset_s = 0.1;
/// s, to either side, over which that clock is searched. Chosen, sensitive.
inline constexpr double kGyroReach_s = 0.5;
/// s, of that search. Chosen, sensitive.
inline constexpr double kGyroStep_s = 0.02;
/// s, between samples of a gyro over which nothing is integrated. Chosen, insensitive.
inline constexpr double kGyroHole_s = 0.1;
/// s, of an interval between pairs, where the gyro alone sees the turn. Chosen, sensitive.
inline constexpr double kBetweenPairs_s = 0.5;
/// rad, both ways together, that a verdict on a gyro needs. Chosen: half a turn.
inline constexpr double kLeastGyroTurn_rad = math::kPi;
/// Share of a gyro's variance that the wheels must explain. Chosen, sensitive.
inline constexpr double kLeastGyroShare = 0.5;
/// Intervals that a verdict on a gyro needs. Chosen, insensitive.
inline constexpr std::size_t kFewestGyroTurns = 20;
/// Ratio of a gyro's turns to the robot's, or its inverse, from which it is stated as a factor. Chosen,
/// sensitive.
inline constexpr double kGyroFactor = 2.0;

// --- Settling --------------------------------------------------------------------------------------------

/// Passes of fitting and matching after which an unchanged clock is enough, and passes at most. Chosen,
/// sensitive.
inline constexpr int kFitPasses = 2, kMostFitPasses = 5;

}  // namespace odomcalib::calib::estimation::settings
