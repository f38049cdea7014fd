// Numbers that decide about motion and counts, for every controller.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

#include <cstddef>

namespace odomcalib::drivers::motion {

// The motion state machine.
/// s between two speed commands. Derived: rule M2, a command is refreshed every
/// 20 ms.
inline constexpr double kCycle_s = 0.02;
/// s after which a command that was not refreshed becomes zero. Derived: five cycles; with the cycle itself a
/// lost program is zero speed within the 0.13 s that the stopping distance counts with.
inline constexpr double kCommandLives_s = 0.1;
/// s, longest wait for the next state of the axes on their way to torque. Chosen: releasing a
/// brake takes some tenths of a second, and a person waits for it.
inline constexpr double kStep_s = 1.0;
/// s, longest ramp to standstill before torque is taken away anyway. Chosen: the highest speed (0.3 m/s) at
/// the weakest deceleration in use (0.2 m/s^2) takes 1.5 s; twice that.
inline constexpr double kEnding_s = 3.0;
/// Events, ticks or pairs kept when nobody takes them. Chosen: 40 s of ticks at 100 Hz; a bound, not a need.
inline constexpr std::size_t kMostQueued = 4096;

// Other masters.
/// s after which another master is announced again. Chosen: once for a person who reads along.
inline constexpr double kOtherMasterAgain_s = 10.0;

// StuckWatch: counts that stand still although their wheel is commanded.
/// rad, s, counts commanded before a wheel that has not broken away yet is stuck. Chosen: more than the play
/// of a gear, and no shorter than a slow drive's ramp.
inline constexpr double kStart_rad = 0.15;
inline constexpr double kStart_s = 0.3;
inline constexpr double kStart_ticks = 3.0;
/// s without a new count of a wheel that was turning. Derived: found within 100 ms with readings every 10 ms.
inline constexpr double kFrozen_s = 0.075;
/// rad/s, counts, readings: below them a turning wheel may stand as long. Chosen: five counts leave a wrong
/// count or two; three readings are no single late one.
inline constexpr double kFrozenRate_rad_s = 0.5;
inline constexpr double kFrozen_ticks = 5.0;
inline constexpr unsigned kFrozenReadings = 3;
/// Times the longest pause seen while turning. Chosen, for drives that refresh their counts slowly.
inline constexpr double kPauses = 2.0;

// TickUnwrap: motion or a jump of the counter.
/// Times the highest speed that is still motion. Chosen: a speed loop overshoots by less.
inline constexpr double kSpeedMargin = 1.5;
/// s, least time between two counts. Derived: queued frames arrive together, their true distance is unknown.
inline constexpr double kShortest_s = 0.005;
/// Counts of an encoder that stands on an edge. Chosen: two edges of four, each way.
inline constexpr double kNoise_ticks = 8;

// TickPairing: counts of two wheels in separate messages.
/// s within which two dates are one. Derived: dates are seconds in double precision since 1970, 0.2 us fine.
inline constexpr double kSameInstant_s = 1e-6;
/// s between two counts of one side. Chosen: at 0.5 m/s^2 the middle of 0.5 s is wrong by at most 16 mm.
inline constexpr double kLongestGap_s = 0.5;

// TimerDates: process data on a drive's own timer.
/// s late that is still in time. Measured: a drive's jitter and an idle host's stay below 1 ms.
inline constexpr double kPrompt_s = 0.0015;
/// Gain of the filter for the usual lateness. Chosen: some 20 frames.
inline constexpr double kGain = 0.05;

}  // namespace odomcalib::drivers::motion
