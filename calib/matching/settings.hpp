// Numbers that decide how scans are matched, each once, with its unit and its origin: derived (from what),
// published (source), measured (where), chosen (for what reason; or "insensitive", "sensitive", "untried":
// whether calibrations change with its half and its double, see docs/developer/numbers.md). Sizes of tables
// and numbers that only rounding needs stand where they are used.
#pragma once

#include <cstddef>

#include "calib/math/se2.hpp"

namespace odomcalib::calib::matching::settings {

// --- Both ways -------------------------------------------------------------------------------------------

/// Correlation of the errors of both ways: the readings are the same, the walls' ends and pieces are not.
/// Measured: in simulated rooms; 0.8 where furniture was moved between the scans.
inline constexpr double kBothWaysCorrelation = 0.93;

// --- Joint lines -----------------------------------------------------------------------------------------

/// Gauss-Newton steps on the walls of both scans. Chosen, sensitive.
inline constexpr int kMostLineSteps = 10;
/// sigma, a step that no longer matters. Chosen, sensitive.
inline constexpr double kLinesSettled = 0.02;

// --- Likelihood field ------------------------------------------------------------------------------------

/// m; what lies farther out is left out of the map. Chosen, insensitive.
inline constexpr double kLargestMap_m = 200.0;
/// m, side of a cell. Chosen, insensitive.
inline constexpr double kFieldCell_m = 0.1;
/// m; a point farther than this from the reference scores nothing, however far it is. Chosen, insensitive.
inline constexpr double kFieldCap_m = 0.3;

// --- Point to line ---------------------------------------------------------------------------------------

/// Points in correspondence from which a match counts. Chosen, sensitive.
inline constexpr std::size_t kFewestPoints = 20;
/// Cosine between the two scans' normals. Chosen, sensitive.
inline constexpr double kNormalsAgree = 0.8;
/// Cosine; flatter beams say little and err much. Chosen, insensitive.
inline constexpr double kFlattestBeam = 0.2;
/// Steps on a part of the points. Chosen, sensitive.
inline constexpr int kCoarseSteps = 4;
/// Points of the first steps. Chosen, insensitive.
inline constexpr std::size_t kCoarsePoints = 180;
/// Step from which on steps are halved, as correspondences may alternate. Chosen, sensitive.
inline constexpr int kDampedFrom = 12;
/// sigma, a step small enough to leave the rest to the walls. Chosen, sensitive.
inline constexpr double kPointsSettled = 0.5;
/// sigma, without walls to refine on. Chosen, sensitive.
inline constexpr double kPointsSettledAlone = 0.05;
/// m, first gate for correspondences. Chosen, sensitive.
inline constexpr double kFirstDistance_m = 0.5;
/// Share of the gate that is left after a step. Chosen, sensitive.
inline constexpr double kGateShrinks = 0.6;
/// m, and deviations of a range: the last gate, whichever is wider. Chosen, sensitive.
inline constexpr double kLastGate_m = 0.10, kLastGateSigmas = 6.0;
/// Share of the usable points that must find a partner. Chosen, insensitive.
inline constexpr double kLeastOverlap = 0.4;
/// Ratio of the translation information's eigenvalues, below which a direction is open. Chosen, insensitive.
inline constexpr double kDegenerateRatio = 0.01;
/// Steps. Chosen, insensitive.
inline constexpr int kMostMatchSteps = 40;
/// Deviations of a median absolute deviation by which distances may scatter more by chance. Chosen,
/// sensitive.
inline constexpr double kExcessSigmas = 2.0;

// --- Surface ---------------------------------------------------------------------------------------------

/// Points on each side of one that its line is fitted to. Chosen, insensitive.
inline constexpr int kMostNeighbours = 12;
/// m to either side; longer stretches of wall gain nothing and bend at corners. Chosen, sensitive.
inline constexpr double kReachOfLine_m = 0.25;
/// Steps between beams that a line may reach where no more than kFewLines of the points have one. Chosen,
/// sensitive.
inline constexpr double kWideReach = 2.5;
/// Share of the points with a line below which beams are too rare for the narrow reach. Chosen, insensitive.
inline constexpr double kFewLines = 0.33;
/// Points of a local line. Chosen, sensitive.
inline constexpr std::size_t kFewestLinePoints = 4;
/// Accepted rms of a line fit in units of the expected noise. Chosen, sensitive.
inline constexpr double kLineNoise = 2.0;
/// Neighbours further apart than this times the median step, and than range noise makes them, are another
/// surface. Chosen, sensitive.
inline constexpr double kGapOfSurface = 3.5;
/// m, real surfaces and beams are no better than this. Chosen, insensitive.
inline constexpr double kLeastRangeNoise_m = 2e-3;
/// m, largest noise of a range that is taken for one. Chosen, insensitive.
inline constexpr double kMostRangeNoise_m = 5e-2;
/// m, noise of a range where the scan does not show it. Chosen, insensitive.
inline constexpr double kUsualRangeNoise_m = 1e-2;
/// m, angular error of beams and unevenness of surfaces. Chosen, sensitive.
inline constexpr double kBeamFloor_m = 1e-3;
/// Share of the range: some lidars' noise grows with it. Chosen, insensitive.
inline constexpr double kNoiseAfar = 0.03;
/// rad, to either side, over which the bends are taken that show the noise of the ranges. Chosen: corners and
/// edges lie in few of them.
inline constexpr double kBendReach_rad = 1.25 * math::kPi / 180.0;
/// Tangent of the flattest incidence at which a bend is looked at. Chosen: 45 degrees.
inline constexpr double kSteepestBend = 1.0;
/// Deviations at which the normal part of the bends is cut. Chosen, sensitive.
inline constexpr double kNormalCut = 2.5;
/// Deviation of a normal distribution cut there. Derived from kNormalCut.
inline constexpr double kOfCutNormal = 0.9546;

// --- Walls -----------------------------------------------------------------------------------------------

/// Points of a wall. Chosen, sensitive.
inline constexpr std::size_t kFewestWallPoints = 4;
/// rad, deviation of a wall's direction; what is shorter may as well be a corner or a curve. Chosen,
/// insensitive.
inline constexpr double kWallDirection_rad = 0.08;
/// Times the step across the beam, as on a surface seen at 82 degrees. Chosen, sensitive.
inline constexpr double kGapOfWall = 7.0;
/// m, between neighbouring readings of one wall, that is always allowed. Chosen, insensitive.
inline constexpr double kLeastGap_m = 0.02;
/// m between the ends of two pieces of one wall. Chosen, sensitive.
inline constexpr double kJoinGap_m = 1.0;
/// Chi-squared of two degrees of freedom with which two pieces are one wall. Derived: its 99.8 % quantile.
inline constexpr double kJoinSquares = 12.0;
/// Cosine between the normals of pieces of one wall. Chosen, sensitive.
inline constexpr double kJoinCosine = 0.9;
/// m, about one beam to the next. Chosen, sensitive.
inline constexpr double kEndMargin_m = 0.03;
/// Deviations of a range, if that is more. Chosen, sensitive.
inline constexpr double kEndMarginSigmas = 3.0;
/// m, unevenness of surfaces and angular error of beams. Chosen, sensitive.
inline constexpr double kSurfaceFloor_m = 1e-3;
/// Cosine; a flatter beam meets an uneven wall far from where it ends. Chosen, sensitive.
inline constexpr double kFlatCosine = 0.5;
/// Standard deviations of the curvature of a wall that is none. Chosen, sensitive.
inline constexpr double kPlainArc = 5.0;
/// Cosine of a beam on a wall; flatter beams say little and err much. Chosen: 80 degrees.
inline constexpr double kFlattestWallBeam = 0.17;

// --- Pose search ----------------------------------------------------------------------------------------

/// m and rad, half of a search window without further knowledge. Chosen, insensitive.
inline constexpr double kSearchHalfWidth_m = 1.0, kSearchHalfAngle_rad = math::kPi / 4.0;
/// rad, step in yaw. Chosen: one and a half degrees.
inline constexpr double kSearchAngleStep_rad = math::kPi / 120.0;
/// m and rad, first steps of a climb. Chosen: half a cell and half a degree.
inline constexpr double kClimbStep_m = 0.05, kClimbStep_rad = math::kPi / 360.0;
/// Finer steps of a climb after no neighbour is better. Chosen, insensitive.
inline constexpr int kClimbHalvings = 4;

// --- Probability grid -----------------------------------------------------------------------------------

/// Probability of a cell to be occupied, given that a beam ended in it, and that one passed it. Published: A.
/// Hornung et al., OctoMap, Autonomous Robots 34, 2013.
inline constexpr double kGridHit = 0.7, kGridPass = 0.4;
/// Probability that no cell exceeds, so that what moved can be unlearnt. Published: OctoMap, as above.
inline constexpr double kGridLimit = 0.97;

// --- Point to point -------------------------------------------------------------------------------------

/// Points in correspondence from which a motion is computed. Derived: two determine it, one more shows an
/// error.
inline constexpr std::size_t kFewestIcpPoints = 3;
/// m; correspondences farther apart are left out. Chosen as kFirstDistance_m.
inline constexpr double kIcpDistance_m = 0.5;
/// Share of the points that must find a partner. Chosen as kLeastOverlap.
inline constexpr double kIcpOverlap = 0.4;
/// Steps. Chosen, untried.
inline constexpr int kMostIcpSteps = 100;

}  // namespace odomcalib::calib::matching::settings
