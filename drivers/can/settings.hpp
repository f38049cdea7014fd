// Numbers that decide about ways onto a CAN bus and about logs of one.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

#include <cstddef>

namespace odomcalib::drivers::can {

// SocketCAN.
/// Frames a call. Derived: 512 frames are 60 ms of a full bus at 1 Mbit/s and 1 ms of work in the loop.
inline constexpr int kFramesAtMost = 512;
/// s; an older stamp means that the wall clock was set meanwhile. Chosen: a loop that was held up for so long
/// has stopped the robot.
inline constexpr double kOldest_s = 1.0;
/// s from one call to the next that a clock's adjustment cannot make. Derived: the kernel slews a clock by
/// 500 ppm, 10 us in a turn of the loop.
inline constexpr double kStep_s = 0.005;

// Lawicel adapters.
/// s in which what a previous user had left comes to its end. Chosen: several times the latency timer of a
/// USB adapter (16 ms).
inline constexpr double kDrain_s = 0.100;
/// s until the answer to a set-up command is overdue. Chosen: as kDrain_s, and time for the adapter.
inline constexpr double kAnswer_s = 0.250;
/// Characters of a line. Derived: FD frames of 64 bytes have 142.
inline constexpr std::size_t kLongestLine = 150;
/// bit/s for USB-CDC devices, which ignore it. Chosen.
inline constexpr unsigned kAnyBaud = 115'200;

// candump logs.
/// s since 1970 that no clock says. Chosen: year 5138.
inline constexpr double kLatest_s = 1e11;

}  // namespace odomcalib::drivers::can
