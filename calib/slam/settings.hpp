// Numbers that decide which places tie a graph together, how far its edges are believed, how it settles and
// what becomes a map, each once, with its unit and its origin (see calib/matching/settings.hpp).
#pragma once

#include <cstddef>

namespace odomcalib::calib::slam::settings {

// --- Keyframes -------------------------------------------------------------------------------------------

/// m of travel and rad turned, from keyframe to keyframe. Chosen, insensitive.
inline constexpr double kKeyframeDistance_m = 0.5, kKeyframeRotation_rad = 0.5;

// --- Loop check ------------------------------------------------------------------------------------------

/// m and rad, half of the least search window. Chosen, insensitive.
inline constexpr double kLoopHalfWidth_m = 1.0, kLoopHalfAngle_rad = 0.5;
/// Readings of either scan from which a loop is looked at. Chosen, insensitive.
inline constexpr std::size_t kFewestLoopPoints = 40;
/// Share of the scan's lines that find their partner. Chosen, insensitive.
inline constexpr double kLoopOverlap = 0.55;
/// Share of the points of one scan that may lie in what the other saw as free. Chosen, insensitive.
inline constexpr double kMostIntrusion = 0.08;
/// Ratio of scores from which a far pose makes the best one ambiguous. Chosen, insensitive.
inline constexpr double kCompetitorScore = 0.97;
/// Directions of a turn in which free space is known. Chosen: half a degree each.
inline constexpr std::size_t kFreeSpaceBins = 720;
/// m in front of a surface, of what lies in free space. Chosen: beyond noise and errors of the motion.
inline constexpr double kClearance_m = 0.3;
/// Points of a scan that is searched for. Chosen: more tell little on cells of 10 cm.
inline constexpr std::size_t kLoopSearchPoints = 120;
/// m, width of the summit about the best pose. Chosen, insensitive.
inline constexpr double kSummit_m = 0.4;
/// Robust deviation of the distances, over what is expected, of surfaces that agree. Chosen, sensitive.
inline constexpr double kMostLoopResidual = 2.0;

// --- Scan graph ------------------------------------------------------------------------------------------

/// m of path, with kTurnLever_m for turns, before a place counts as seen again. Chosen, insensitive.
inline constexpr double kLeastWayRound_m = 4.0;
/// m and rad of error that matches and odometry gather per root of a metre. Chosen, insensitive.
inline constexpr double kDrift = 0.04;
/// m and rad a step, deviation of odometry before anything is learnt. Chosen, insensitive.
inline constexpr double kOdometrySigma = 0.1;
/// m of path that a radian counts for. Chosen, sensitive.
inline constexpr double kTurnLever_m = 0.5;
/// Places that a keyframe is compared with, per least search window. Chosen, sensitive.
inline constexpr double kPlacesTried = 4.0;
/// rad, of a view that sees the same in every direction. Chosen: 300 degrees.
inline constexpr double kAllRoundView_rad = 5.2;
/// Share of a limited view that two scans of one place must have in common. Chosen: half.
inline constexpr double kSharedView = 0.5;
/// Keyframes before and after one that show the same place. Chosen, insensitive.
inline constexpr std::size_t kSamePlaceAbout = 2;
/// Keyframes between two places that a keyframe is compared with. Chosen, sensitive.
inline constexpr std::size_t kPlacesApart = 3;
/// Keyframes within which a loop must be confirmed. Chosen, sensitive.
inline constexpr std::size_t kConfirmedWithin = 5;
/// Keyframes, or m, between what two loops that confirm each other lead to. Chosen, sensitive.
inline constexpr std::size_t kSamePlaceKeyframes = 8;
inline constexpr double kSamePlace_m = 1.0;
/// m and rad, between two loops that agree. Chosen, insensitive.
inline constexpr double kLoopsAgree_m = 0.15, kLoopsAgree_rad = 0.5 * kLoopsAgree_m;
/// m and rad, half of the widest search window. Chosen, insensitive.
inline constexpr double kWidestSearch_m = 3.0, kWidestSearch_rad = 0.8;
/// chi2 of a new loop after settling, with three degrees of freedom. Chosen, insensitive.
inline constexpr double kMostLoopChi2 = 30.0;
/// m and rad; neighbouring matches err together, which their covariance ignores. Measured: what most edges of
/// the Intel lab's graph leave; the few that leave more lose weight.
inline constexpr double kMotionFloor_m = 2e-3, kMotionFloor_rad = 1.5e-3;
/// Share of the lines, of neighbours. Chosen: doors and corners hide much from one step to the next.
inline constexpr double kNeighbourOverlap = 0.25;
/// m and rad, between a match of neighbours and odometry. Chosen, insensitive.
inline constexpr double kMostFromOdometry = 0.5;
/// The same in deviations of odometry, as learnt so far. Chosen, insensitive.
inline constexpr double kMostOdometrySigmas = 6.0;

// --- Odometry correction ---------------------------------------------------------------------------------

/// Deviation of the correction's entries before anything is learnt. Chosen: ten per cent, or 6 degrees a
/// metre.
inline constexpr double kCorrectionPrior = 0.1;
/// Steps that the first deviation counts for. Chosen, sensitive.
inline constexpr double kPriorSteps = 5.0;
/// m and rad, of a corrected step. Chosen, sensitive.
inline constexpr double kLeastOdometrySigma = 0.01;

// --- Robust weights --------------------------------------------------------------------------------------

/// Deviations at which Cauchy's weights fall to one half. Derived: 95 % efficiency at the normal
/// distribution.
inline constexpr double kCauchyCut = 2.385;
/// Rounds of weights. Chosen: they change little from then on.
inline constexpr int kWeightRounds = 10;

// --- Descent ---------------------------------------------------------------------------------------------

/// Iterations, and share of chi2 that may be left to gain. Chosen, insensitive.
inline constexpr int kMostIterations = 100;
inline constexpr double kGraphTolerance = 1e-10;
/// Iterations of a first guess that is not as good as it might be. Chosen: a good one needs three to five.
inline constexpr std::size_t kManyIterations = 8;
/// First damping, beside a diagonal scaled to 1. Chosen, sensitive.
inline constexpr double kFirstLambda = 1e-4;
/// Largest damping. Chosen: steps are rounding then.
inline constexpr double kLargestLambda = 1e12;
/// Damping under which a small step says that the slope is small. Chosen, insensitive.
inline constexpr double kSlightLambda = 1e-3;
/// Share of the full step, in the line search. Chosen, untried.
inline constexpr double kShortestStep = 1e-6;
/// Share of the promised fall (Armijo's condition) with which a step is taken. Chosen, insensitive.
inline constexpr double kSufficientFall = 1e-4;
/// Share of the promised fall with which the linear model holds. Chosen, sensitive.
inline constexpr double kFairFall = 0.75;
/// Ratio of a fall to the one before it; falls that shrink at least this fast may be extrapolated. Chosen,
/// insensitive.
inline constexpr double kSteadyRate = 0.1;

// --- Map of a recording ----------------------------------------------------------------------------------

/// m, side of the finest cell. Chosen, insensitive.
inline constexpr double kFinestCell_m = 0.05;
/// Cells from the origin to the map's edge. Chosen: 64 MB.
inline constexpr double kMostCells = 2000.0;
/// Probability of an occupied cell. Chosen: one beam that ended there says 0.7.
inline constexpr double kOccupied = 0.6;
/// m from the origin, beyond which no map is drawn. Chosen, insensitive.
inline constexpr double kFarthestReading_m = 1e3;

// --- What a graph holds ----------------------------------------------------------------------------------

/// Edges that are named as the worst. Chosen, sensitive.
inline constexpr std::size_t kWorstEdges = 5;

}  // namespace odomcalib::calib::slam::settings
