// Numbers that decide about turns and their stamps, for every lidar.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

#include <cstddef>
#include <cstdint>

namespace odomcalib::drivers::lidar {

// Sweep.
/// Part of a turn below which it is a short scan. Chosen: a lost packet of 12 in 450 passes, a lost tenth
/// not.
inline constexpr double kUsualShare = 0.9;
/// Beams of a turn. Derived: 32,000 samples/s at 2 Hz are 16,000; a bound on memory.
inline constexpr std::size_t kMostBeams = 100'000;

// StampLine.
/// Turns under the line. Chosen: some seconds, in which a motor drifts less than a coarse stamp is off.
inline constexpr std::size_t kTurns = 100;
/// Turns that may be missing between two stamps. Chosen: beyond, the count of turns is a guess.
inline constexpr std::int64_t kMostLost = 20;
/// Deviation from whole turns, in periods per turn. Derived: half a period would be the next number.
inline constexpr double kMostMisfit = 0.4;
/// Relative deviation from the nominal period. Chosen: cheap motors are off by several per cent.
inline constexpr double kMostDeviation = 0.2;
/// Stamps from which on the measured period counts. Chosen: before, a stamp of 1 ms is worse than the data
/// sheet.
inline constexpr std::size_t kTrusted = 5;

}  // namespace odomcalib::drivers::lidar
