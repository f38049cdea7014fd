// Numbers that decide about CiA 402 drives.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

namespace odomcalib::drivers::cia402 {

// Life signs.
/// s between our heartbeats. Derived: a tenth of the drive's watchdog of 200 ms; nine may be late.
inline constexpr double kOwnHeartbeat_s = 0.02;
/// Heartbeats of the drive that may be missing. Chosen: one may be lost, two late; at 30 ms within 100 ms.
inline constexpr int kMissedHeartbeats = 3;
/// s without process data. Derived: rule M4, counts are at most 100 ms old.
inline constexpr double kPositionsLive_s = 0.1;

// Set-up.
/// s of listening for other masters before the first word. Chosen: two periods of the slowest usual
/// heartbeat.
inline constexpr double kListen_s = 0.2;
/// Receive PDOs of a node that are looked for. Chosen: drives have four to eight; CiA 301 allows 512.
inline constexpr std::uint16_t kMostReceivePdos = 32;
/// s until a node that does not answer is asked again. Chosen: found within 2 s after it is switched on.
inline constexpr double kAskAgain_s = 0.3;
/// s until a node whose configuration failed is asked again. Chosen: the event must stay readable.
inline constexpr double kFailedAgain_s = 3.0;
/// s until a node that was lost is asked again. Chosen: its boot-up message makes it sooner.
inline constexpr double kLostAgain_s = 0.1;
/// s of silence of another master before we configure. Chosen: longer than any cyclic master pauses.
inline constexpr double kOtherMaster_s = 2.0;
/// s from NMT start to the first process data. Chosen: event timers go up to 1 s.
inline constexpr double kStart_s = 2.0;
/// s after a reset until a node that sends no boot-up message is asked. Chosen: slow drives boot in 2 s.
inline constexpr double kBoot_s = 3.0;
/// s from a reset to configured, then its job is given up. Chosen: boot, configuration and start together.
inline constexpr double kRestart_s = 10.0;

// Motion.
/// s of standing counts that are rest. Derived: ten process data at the usual 10 ms.
inline constexpr double kRest_s = 0.1;
/// s between zero commands without motion. Derived: a vendor's command time-out of 200 ms must not fire.
inline constexpr double kIdleCycle_s = 0.05;
/// Cycles of half a period of the fault reset's edge. Chosen: drives that look every 50 ms see it.
inline constexpr unsigned kResetCycles = 4;
/// s after a SYNC; later process data belong to none that we know of. Chosen: longer than any SYNC period
/// used.
inline constexpr double kSyncLives_s = 0.05;

}  // namespace odomcalib::drivers::cia402
