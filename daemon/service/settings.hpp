// Numbers that decide how the service waits, retries and bounds what it keeps, each once, with its unit and
// its origin: derived (from what), or chosen (for what reason; where none is given, no comparison with other
// values is known).
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace odomcalib::service::settings {

// --- Loop ------------------------------------------------------------------------------------------------

/// ms that a turn waits in motion. Derived: control steps every 10 ms need a loop that turns faster.
inline constexpr int kMovingTurn_ms = 5;
/// s between looks at a device or client that says nothing. Chosen.
inline constexpr double kIdleStep_s = 0.020;
/// s for calls of clients in one turn. Derived: what is left of the 20 ms between two motion commands (M2)
/// beside the longest single call, a dry run of a calibration (12 ms on two cores of 2.5 GHz).
inline constexpr double kCallTime_s = 0.004;
/// Turns in a row that do not wait because calls wait, and serve none, or that are woken by something and
/// take nothing from it. Chosen: some 10 ms of a loop that turns as fast as it can, and no chance.
inline constexpr std::size_t kMostIdleTurns = 1000;
/// s without a wait that had nothing to do, and ms of rest after them. Derived: a tenth of the unit's
/// LimitRTTIME; a hundredth of the processor for others.
inline constexpr double kLongestAwake_s = 0.100;
inline constexpr int kRest_ms = 1;
/// ms that a turn waits otherwise, and while the daemon ends. Chosen.
inline constexpr int kTurn_ms = 20, kEndingTurn_ms = 5;
/// s between status lines for the service manager where there is no watchdog. Chosen.
inline constexpr double kStatusLine_s = 1.0;

// --- End of the daemon -----------------------------------------------------------------------------------

/// s, shortest. Chosen: at rest the axes are off after 0.1.
inline constexpr double kShortestEnd_s = 0.25;
/// s until the wheels stand. Chosen.
inline constexpr double kLongestEnd_s = 1.5;
/// s until a write-back has ended. Chosen: below the unit's TimeoutStopSec.
inline constexpr double kLongestWrite_s = 8.0;
/// s over which a quick stop without the service is sent. Derived: identity of a drive, four answers of 50 ms
/// each at worst.
inline constexpr double kQuickStop_s = 0.5;
/// s until then in which an adapter may be set up. Derived: one that answers nothing takes 0.9 s.
inline constexpr double kQuickStopSetUp_s = 1.0;
/// ms between two looks in it. Chosen.
inline constexpr std::chrono::milliseconds kQuickStopPause{5};

// --- Devices ---------------------------------------------------------------------------------------------

/// s between attempts to open the controller's bus. Chosen: a device is back in use within 2 s without
/// spinning while it is away.
inline constexpr double kBaseRetry_s = 0.5;
/// s between attempts to open the lidar, first and longest, and for one attempt to connect. Chosen: a device
/// that is back is found within 2 s, the longest pause and one attempt.
inline constexpr double kLidarFirstRetry_s = 0.2, kLidarLastRetry_s = 0.8, kLidarConnect_s = 1.0;
/// s without one valid packet, until it is reported as a problem. Chosen.
inline constexpr double kLidarWatch_s = 2.0;
/// Share of a length; one that is further from what is known of it is another robot's. Chosen.
inline constexpr double kPlausibleLength = 0.15;
/// m or rad of deviation with which the lidar's place is not known at all. Chosen.
inline constexpr double kMostLidarStd = 10.0;
/// Value or deviation of an effect's parameter, in its own unit, beyond which it is none. Chosen: the largest
/// bound of an effect is 1e6 s.
inline constexpr double kMostOfEffect = 1e7;

// --- Clients ---------------------------------------------------------------------------------------------

/// Clients at a time. Chosen.
inline constexpr std::size_t kMostClients = 8;
/// Beyond those, for whoever wants to stop the robot (M15). Chosen.
inline constexpr std::size_t kSpareClients = 2;
/// Bytes waiting for one slow client. Chosen.
inline constexpr std::size_t kMostOutput_bytes = std::size_t{8} << 20;
/// Calls of one client a turn. Chosen: a client waits for answers and has one call at a time; 16 let one
/// that does not get on, and leave eight others their place in the same turn.
inline constexpr std::size_t kCallsPerTurn = 16;
/// Clients taken in a turn. Chosen: a flood of them does not keep the loop from its turn.
inline constexpr int kAcceptsPerTurn = 16;
/// Letters of a recording's name. Chosen: well below what file systems take.
inline constexpr std::size_t kLongestName = 64;
/// Recordings that a calibration may go with. Chosen.
inline constexpr std::size_t kMostEarlier = 8;
/// Least and most of what a client may ask for. Chosen. The texts that refuse say them too.
inline constexpr double kLeastSpeed_m_s = 0.02, kMostSpeed_m_s = 10.0;
inline constexpr double kLeastDistance_m = 0.05, kMostDistance_m = 5.0;
inline constexpr double kLeastSide_m = 0.3, kMostSide_m = 5.0;
inline constexpr double kLeastTurns = 0.05, kMostTurns = 10.0;
inline constexpr double kLeastRate_rad_s = 0.05, kMostRate_rad_s = 10.0;
inline constexpr double kLongestRecord_s = 3600.0;
/// m, length of the straight of a calibration: no more than that, and than this share of the area. Chosen.
inline constexpr double kUsualStraight_m = 1.0, kStraightShareOfArea = 0.45;

// --- Events ----------------------------------------------------------------------------------------------

/// Events of one kind at once, and s for one more. Chosen: whoever drives one short motion after the other
/// stays below it; a device that comes and goes all day leaves some 17,000 lines.
inline constexpr double kEventsAtOnce = 20.0, kEventPause_s = 5.0;

// --- Telemetry -------------------------------------------------------------------------------------------

/// s between messages of the same kind. Chosen.
inline constexpr double kRobotPeriod_s = 10.0, kStatusPeriod_s = 1.0, kProgressPeriod_s = 0.2;
/// s for which progress that was sent is that of what runs now. Derived: five periods, in case one is late.
inline constexpr double kProgressLasts_s = 5.0 * kProgressPeriod_s;
/// Points of a scan that is asked for. Chosen: half a degree of a full turn, as viewers show.
inline constexpr std::size_t kMostScanPoints = 720;
/// s between attempts to open the network. Chosen.
inline constexpr double kPublisherRetry_s = 5.0;
/// Messages, and bytes of them, that wait for the network. Derived: a second of a usual robot (counts at 50
/// to 100 Hz in three messages each, ten scans); the largest message is a calibration with its paths (1 MB).
inline constexpr std::size_t kMostUnsent = 512, kMostUnsent_bytes = std::size_t{4} << 20;
/// How long what waits may take to leave when the daemon ends. Chosen: a network that works takes no time.
inline constexpr std::chrono::milliseconds kPublisherEnd{200};

// --- Recordings ------------------------------------------------------------------------------------------

/// Bytes of a recording. Chosen.
inline constexpr std::uint64_t kLargestRecording_bytes = std::uint64_t{512} << 20;
/// Bytes of frames in it. Chosen: measurements come first.
inline constexpr std::uint64_t kMostFrames_bytes = kLargestRecording_bytes / 2;
/// MB of space on the disk without which none begins, and `check` finds too little. Chosen. The text that
/// refuses says it too.
inline constexpr std::uintmax_t kLeastSpace_MB = 64;
/// Recordings that the disk has not finished. Chosen.
inline constexpr std::size_t kMostUnfinished = 4;
/// Items waiting for the disk. Derived: 8 s of a bus at its limit.
inline constexpr std::size_t kMostItems = 32768;
/// Bytes waiting for the disk. Chosen: minutes of a usual robot.
inline constexpr std::size_t kMostWaitingForDisk_bytes = std::size_t{32} << 20;

// --- Motion ----------------------------------------------------------------------------------------------

/// s of a whole plan. Chosen: a preview of it takes some 10 ms of the loop.
inline constexpr double kLongestPlan_s = 1800.0;
/// s between control steps. Chosen (rule M2 asks for a command every 20 ms).
inline constexpr double kControlStep_s = 0.010;
/// s between control steps that is reported as late, and that stops the robot (rule M1). Chosen.
inline constexpr double kNoticedPause_s = 0.050, kLongestPause_s = 0.200;
/// s until the drive has torque. Chosen.
inline constexpr double kEnableTimeout_s = 3.0;
/// s at rest before and after. Chosen: several scans without motion.
inline constexpr double kStanding_s = 0.6;
/// s from the last command until a whole scan is one of a robot at rest. Chosen.
inline constexpr double kComeToRest_s = 0.35;
/// Scans at rest whose mean is taken. Chosen: more of them hardly add to it.
inline constexpr std::size_t kMostAtRest = 5;

/// s of odometry that is remembered. Derived: a scan of the slowest lidar (5 Hz) and what it takes to arrive.
inline constexpr double kPoseMemory_s = 1.0;

// --- Agreement of odometry and lidar ---------------------------------------------------------------------

/// m or rad, of motion from one comparison to the next. Rule M9: 0.1 m or 30 degrees.
inline constexpr double kJudgedWay_m = 0.1, kJudgedTurn_rad = 0.5236;
/// m or rad, of motion since the earlier scan, after which the newest one takes its place. Chosen: over a
/// longer way a smaller share of it stands out from the error of a match.
inline constexpr double kComparedWay_m = 0.25, kComparedTurn_rad = 0.6;
/// m or rad that the robot may go without a comparison. Rule M9: 0.3 m or 60 degrees.
inline constexpr double kUnjudgedWay_m = 0.3, kUnjudgedTurn_rad = 1.0472;
/// Disagreements in a row that are a fact. Chosen: one bad match must not stop the robot.
inline constexpr int kDisagreements = 2;
/// rad, of headings that a match is tried from, and rad turned below which only the first is. Chosen.
inline constexpr std::array kTriedHeadings_rad = {0.0, 0.09, -0.09, 0.18, -0.18};
inline constexpr double kSmallTurn_rad = 1.0;

// --- Write-back ------------------------------------------------------------------------------------------

/// s from the end of a motion until the drive has no torque. Chosen: it takes one.
inline constexpr double kComesToRest_s = 2.0;
/// s after a reading that may have failed. Chosen.
inline constexpr double kReadAgain_s = 2.0;
/// s between looks at a history that cannot be listed. Chosen: who has mended the folder waits no longer.
inline constexpr double kLookAgain_s = 2.0;
/// s since somebody else was last seen to change the controller, until it is read again. Chosen: longer than
/// any program pauses that sets up a drive; a person who asks for a motion then waits no longer.
inline constexpr double kOthersQuiet_s = 1.0;
/// s until a recovery may follow on one that failed, each time twice as long. Derived: a recovery may store;
/// permanent memory is good for 100 000 stores, at one each ten minutes for two years.
inline constexpr double kRecoverAgain_s = 2.0, kLongestRecoverAgain_s = 600.0;

/// s from the write to the store in which a motion proves the values. Chosen: a straight and a spin out and
/// back take two minutes.
inline constexpr double kLongestProof_s = 900.0;

// --- Calibrations ----------------------------------------------------------------------------------------

/// Calibrations whose files are kept. Chosen: those of months; each has some 100 kB.
inline constexpr std::size_t kMostCalibrations = 200;

// --- Solver ----------------------------------------------------------------------------------------------

/// ms that one look for a solver's answers waits. Chosen.
inline constexpr int kAskedAgain_ms = 100;
/// Real-time priority of the loop. Chosen: before every usual program, behind threads of the kernel (50).
inline constexpr int kLoopPriority = 5;
/// us. Chosen: as LimitRTTIME of the unit; five times the delay that stops the robot.
inline constexpr std::uint64_t kLongestAwake_us = 1'000'000;
/// Niceness. Chosen: the control loop has the processor first.
inline constexpr int kLessUrgent = 10;
/// MiB of its data. Chosen: a recording of 157 MB takes 266 MB; the unit's limit leaves the service the rest.
inline constexpr std::uint32_t kSolverMemory_MiB = 768;

}  // namespace odomcalib::service::settings
