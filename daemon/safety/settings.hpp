// Numbers that decide whether the robot may move, each once, with its unit and its origin: derived (from
// what), or chosen (for what reason; where none is given, no comparison with other values is known).
#pragma once

#include <cstddef>
#include <numbers>

namespace odomcalib::safety::settings {

// --- Lease -----------------------------------------------------------------------------------------------

/// s without a renewal. Derived: rule M3 grants 250 ms until the wheels stand still; a control step, the
/// quick stop and the lag of the motors take about 115 ms of them.
inline constexpr double kLeaseTime = 0.120;
/// s between two looks from which on the daemon counts as held up. Chosen: the loop looks every 10 ms at
/// least.
inline constexpr double kLateLook = 0.040;
/// s that a client gets after such a look. Chosen: two of its renewals.
inline constexpr double kSecondChance = 0.060;
/// s without a renewal, however late the daemon was. Chosen.
inline constexpr double kLongestSilence = 0.300;

// --- Freshness -------------------------------------------------------------------------------------------

/// s without counts, and without a new scan. Chosen (rule M4).
inline constexpr double kEncoderTimeout = 0.100;
inline constexpr double kScanTimeout = 0.250;
/// rad/s of a wheel, below which a coarse encoder may rightly stand still for a while. Chosen.
inline constexpr double kTurning_rad_s = 0.2;
/// s that a drive needs to break away; afterwards the count of a turning wheel must change. Chosen.
inline constexpr double kBreakAway_s = 0.4;
/// s, of a count that does not change. Chosen.
inline constexpr double kFrozen_s = 0.3;

// --- Envelope --------------------------------------------------------------------------------------------

/// m and rad that every run may move. Chosen: spins wander a little; a run that should not move at all still
/// needs room for that.
inline constexpr double kLeastReach_m = 0.25, kLeastTurn_rad = 0.6;
/// Times the farthest point, the largest turn and the duration of the preview. Chosen.
inline constexpr double kReachAllowed = 1.3, kTurnAllowed = 1.25, kTimeAllowed = 1.5;
/// m and rad from which on odometry and the lidar are compared. Rule M9: 0.1 m or 30 degrees.
inline constexpr double kJudgedDistance_m = 0.1, kJudgedTurn_rad = 0.5236;
/// Share by which they may differ. Chosen.
inline constexpr double kTolerance = 0.15;
/// m and rad beyond it: the error of a scan match in motion. Chosen.
inline constexpr double kMatchDistance_m = 0.03, kMatchTurn_rad = 0.035;
/// m by which the lidar may sit elsewhere than stated before it is calibrated: a turn shows that as a motion
/// of the base, up to twice as long. Chosen: a place that was measured by hand.
inline constexpr double kMountError_m = 0.05;

// --- Cover -----------------------------------------------------------------------------------------------

/// s that a direction counts as seen. Chosen: the slowest lidars turn five times meanwhile.
inline constexpr double kRemembered_s = 1.0;
/// rad that a beam speaks for on either side. Chosen: three degrees between beams leave no gap.
inline constexpr double kBeside_rad = 1.5 / (180.0 / std::numbers::pi);
/// Bins of a turn, and bins of a blind sector. Chosen: two degrees each.
inline constexpr std::size_t kBins = 180, kLeastBins = 3;
/// m, between points on the outline of the robot. Chosen.
inline constexpr double kEdgeStep_m = 0.05;

// --- Obstacles -------------------------------------------------------------------------------------------

/// m ahead of the stopping distance, and beside the robot. Chosen.
inline constexpr double kMargin_m = 0.30, kSideMargin_m = 0.05;
/// s until the robot brakes, beyond one period of the lidar. Derived: a control step, and the way of the
/// command over the bus.
inline constexpr double kReaction_s = 0.03;
/// Turns of the lidar, the slowest of which counts as its period. Chosen: a second or two.
inline constexpr std::size_t kPeriods = 10;
/// m/s^2, braking. Chosen.
inline constexpr double kBraking = 0.5;
/// Readings that are an obstacle, and free scans in a row that release it. Chosen.
inline constexpr int kPoints = 3, kReleaseScans = 5;
/// m/s, of a motion that is a turn on the spot. Chosen.
inline constexpr double kSpin_m_s = 0.02;
/// Steps of an arc ahead. Chosen.
inline constexpr int kArcSteps = 12;

/// m, edge of a cell of the map of the required space, and cells that it has at most. Chosen: a wheel is
/// seen, and it fits a terminal.
inline constexpr double kMapCell_m = 0.1, kMapCells = 40.0;
/// m that it shows around. Chosen.
inline constexpr double kMapMargin_m = 0.3;

// --- Braking ---------------------------------------------------------------------------------------------

/// Share by which a command falls that is a stop or the beginning of one. Chosen: rounding is less.
inline constexpr double kFallsBy = 0.02;
/// s of a command that stays, after which the robot drives and does not brake. Chosen: no ramp is so slow.
inline constexpr double kSteady_s = 0.3;
/// m/s of a robot at rest, and s that it is so. Chosen: a count of the coarsest encoders now and then.
inline constexpr double kRests_m_s = 0.01, kRests_s = 0.1;
/// m/s from which a stop is measured, and stops that count. Chosen: half the usual speed; those of a run.
inline constexpr double kMeasuredFrom_m_s = 0.1;
inline constexpr std::size_t kStops = 10;

// --- Speed watch ------------------------------------------------------------------------------------------

/// s over which a speed is measured. Chosen: two readings of the slowest controllers.
inline constexpr double kSpeedWindow_s = 0.2;
/// Share of the limit that a speed controller may go beyond it. Chosen.
inline constexpr double kOvershoot = 0.2;
/// m/s and rad/s beside it. Chosen: one count of the coarsest encoders more or less in the window.
inline constexpr double kCoarse_m_s = 0.02, kCoarse_rad_s = 0.05;
/// s by which a drive may follow its command late. Chosen: 85 ms were seen of motors with a ramp of their
/// own.
inline constexpr double kDriveLag_s = 0.3;
/// m/s and rad/s beyond the command and the share above, of a speed that nobody commanded. Chosen: a fifth
/// and a third of the caps; sticking wheels that break loose stay below.
inline constexpr double kOffCommand_m_s = 0.06, kOffCommand_rad_s = 0.2;

}  // namespace odomcalib::safety::settings
