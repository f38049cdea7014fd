// Numbers that decide how covariates are computed from the wheels, each once, with its unit and its origin
// (see calib/matching/settings.hpp).
#pragma once

#include <cstddef>

namespace odomcalib::calib::vehicle::settings {

// --- Drive history ---------------------------------------------------------------------------------------

/// m/s; below, the direction of travel is undefined and the last one is kept ... Chosen, insensitive.
inline constexpr double kStandingSpeed = 0.005;
/// ... as below this share of the rims' speed in a turn: on the spot, wheels that are not quite alike and
/// drives that do not quite keep their speed move the middle of the axle to and fro. Chosen, insensitive.
inline constexpr double kOnTheSpotShare = 0.1;
/// Track widths, of a caster's pivot behind the axle. Chosen: it only matters that a spin moves it
/// sideways.
inline constexpr double kCasterBehind = 0.6;
/// m of the rims over which tyres, belts and gears wind up. Chosen, sensitive.
inline constexpr double kWindWay_m = 0.05;
/// rad, the same of a turn. Chosen, insensitive.
inline constexpr double kWindTurn_rad = 0.15;
/// s, in which what was wound up unwinds at rest. Chosen, sensitive.
inline constexpr double kUnwind_s = 0.15;
/// m/s, change of speed that an acceleration is remembered over. Chosen, insensitive.
inline constexpr double kAccelerationMemory_m_s = 0.1;
/// m or rad: the drive begins as if the last reversal and the last stop lay so far back. Chosen, insensitive.
inline constexpr double kBeforeTheDrive = 1e3;
/// Counts; coming back by no more is no reversal. Chosen, sensitive.
inline constexpr double kDither = 1.5;

// --- Step context ----------------------------------------------------------------------------------------

/// s; differences of raw ticks over less are mostly quantisation noise. Chosen, sensitive.
inline constexpr double kSmoothing_s = 0.25;
/// m; ticks from which on shorter times show nothing else either. Chosen, insensitive.
inline constexpr double kCoarse_m = 5e-4;
/// m/s, slowest speed that is no standing. Chosen, sensitive.
inline constexpr double kSlow = 0.003;
/// The last of them the one in question: odometry knows no later ones. Chosen, sensitive.
inline constexpr std::size_t kSlowIntervals = 3;
/// counts in them, mean of both wheels. Chosen, insensitive.
inline constexpr double kFewCounts = 1.5;
/// m/s^2, deviation of an acceleration that a threshold is compared with. Chosen, insensitive.
inline constexpr double kAccelerationNoise = 0.03;
/// s; stamps are no better than to a millisecond. Chosen, insensitive.
inline constexpr double kShortestAccelerationWindow_s = 0.08;
/// Intervals that a curvature takes, and with some leeway. Derived: a parabola has three coefficients. The
/// leeway is chosen.
inline constexpr std::size_t kCurvatureIntervals = 3;
inline constexpr double kCurvatureLeeway = 3.1;
/// s, over which accelerations are smoothed that a mast with a lag of its own follows: about a moment, and up
/// to it. Chosen: no more than that lag allows.
inline constexpr double kSharp_s = 0.12, kSharpLatest_s = 0.1;

// --- Drive model -----------------------------------------------------------------------------------------

/// s, to either side, over which a velocity is taken. Chosen, sensitive.
inline constexpr double kVelocityReach_s = 0.02;

// --- Effect -----------------------------------------------------------------------------------------------

/// Share of an effect's typical size below which it does not matter to odometry and is not claimed. Chosen:
/// what a scan matcher's own bias in one room amounts to.
inline constexpr double kNegligibleShare = 0.15;

}  // namespace odomcalib::calib::vehicle::settings
