// Numbers that decide how guided motions are driven and judged, each once, with its unit and its origin:
// derived (from what), or chosen (for what reason; where none is given, no comparison with other values is
// known). What each pattern and manoeuvre drives is its own layout and stands there (manoeuvres.cpp).
#pragma once

namespace odomcalib::routines::settings {

// --- Limits ----------------------------------------------------------------------------------------------

/// m/s, rad/s, m/s^2 and rad/s^2 that no configuration can raise (rule M7), and that hold where it says
/// nothing. Chosen.
inline constexpr double kCapSpeed_m_s = 0.30, kCapRate_rad_s = 0.6;
inline constexpr double kCapAcceleration = 0.5, kCapTurnAcceleration = 1.0;

// --- Driving a move --------------------------------------------------------------------------------------

/// Share of the allowed deceleration that braking is planned with. Chosen: drives follow their command with
/// a lag.
inline constexpr double kBrakingShare = 0.7;
/// Slowest pace, as a share of what one second of acceleration gives. Chosen: the last millimetre must not
/// take for ever.
inline constexpr double kCreepShare = 0.04;
/// s, shortest and longest step that a command is taken to act for. Chosen.
inline constexpr double kShortestStep_s = 1e-6, kLongestStep_s = 0.1;
/// Least share of the allowed acceleration. Chosen.
inline constexpr double kLeastHaste = 0.1;

// --- Repetitions -----------------------------------------------------------------------------------------

/// Repetitions of a motion in one call. Chosen. The text that refuses more says it too.
inline constexpr int kMostRepeats = 20;

// --- Preview ---------------------------------------------------------------------------------------------

/// m and rad, of poses that are one. Chosen: fine against any clearance.
inline constexpr double kSamePlace_m = 0.02, kSameHeading_rad = 0.05;
/// s of its steps, the shortest while the robot is fast, the longest while it stands or creeps: half a pose
/// from one to the next; s of the longest preview. Chosen.
inline constexpr double kShortestPreviewStep_s = 0.02, kLongestPreviewStep_s = kLongestStep_s,
                        kLongestPreview_s = 3600.0;

// --- Motions that people ask for -------------------------------------------------------------------------

/// m of a way and of a side, m/s, turns, rad/s where nothing else is asked for. Chosen.
inline constexpr double kUsualWay_m = 1.0, kUsualSpeed_m_s = 0.20;
inline constexpr double kUsualTurns = 1.0, kUsualRate_rad_s = 0.4;
/// s at rest after each move. Chosen.
inline constexpr double kRest_s = 1.0;
/// s at rest after a move that does not say it. Chosen.
inline constexpr double kSettle_s = 0.8;

// --- Pattern and manoeuvres ------------------------------------------------------------------------------

/// s at rest. Chosen: a rest costs time, but each one is a chance to match scans of a standing robot.
inline constexpr double kShortRest_s = 0.5;
/// rad/s of a turn to a heading. Chosen.
inline constexpr double kFacing_rad_s = 0.5;
/// Shares of the allowed acceleration in slow ramps. Chosen: slow, as in the quasi-static test of system
/// identification.
inline constexpr double kStraightHaste = 0.2, kSpinHaste = 0.1;
/// m, half of the area's shorter side, as far as the pattern makes use of it. Chosen.
inline constexpr double kLeastHalf_m = 0.3, kMostHalf_m = 1.25;

// --- Wiring ----------------------------------------------------------------------------------------------

/// m, m/s, rad and rad/s of the nudge. Chosen: 15 degrees.
inline constexpr double kNudge_m = 0.05, kNudgeSpeed_m_s = 0.08;
inline constexpr double kNudge_rad = 0.26, kNudgeRate_rad_s = 0.4;
/// s at rest after each part of it. Chosen: a whole scan at rest.
inline constexpr double kNudgeRest_s = 0.8;
/// Shares of what was commanded: from the first it moved, below the second it did not. Chosen.
inline constexpr double kMoved = 0.4, kStood = 0.15;

}  // namespace odomcalib::routines::settings
