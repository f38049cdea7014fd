// Numbers that decide how a write-back waits and what is kept of it, each once, with its unit and its origin:
// derived (from what), or chosen (for what reason; where none is given, no comparison with other values is
// known).
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>

namespace odomcalib::writeback::settings {

/// s that a reset node's rest may take to be known. Chosen: it is known only when counts have come for a
/// while.
inline constexpr double kWaitForRest_s = 2.0;
/// s for a controller that has left, on the way back to the old values. Chosen: boot and configuration take
/// one, and a configuration that failed is tried again after three.
inline constexpr double kWaitForController_s = 5.0;
/// s for one that is being configured all the time. Derived: of some 70 requests each may be late by a
/// time-out of 0.5 s, there or back.
inline constexpr double kWaitForSetUp_s = 35.0;
/// How often a job of the way back is begun again because the controller left during it. Chosen: a drive that
/// leaves each time is no drive to wait for.
inline constexpr int kMostReturns = 3;
/// Entries of the history. Chosen.
inline constexpr std::size_t kKeptEntries = 50;
/// Bytes of a journal from which a new one begins. Chosen.
inline constexpr std::uintmax_t kRotateAt_bytes = std::uintmax_t{1} << 20;
/// Bytes that the disk holds ready from the first record of a write-back to its last. Derived: a dozen
/// records of 2 kB at most; and the space that becomes free with the last one takes its entry in the history
/// and the calibration in force, of some 100 kB each.
inline constexpr std::uintmax_t kReserved_bytes = std::uintmax_t{256} << 10;

/// Steps of a controller, and m beside them, within which two values are the same to it. Derived: it rounds
/// to half a step; the rest is room for rounding.
inline constexpr double kSameStep = 0.51, kSame_m = 1e-9;

// --- Proof by a drive ------------------------------------------------------------------------------------

/// Noise of a comparison of scans at rest: m over a metre, rad over a turn. Chosen: two to three
/// times the largest error after a calibration in simulated campaigns, and below what a wheel of 0.3 % makes.
inline constexpr double kLengthNoise_m = 0.002, kHeadingNoise_rad = 0.1 * std::numbers::pi / 180.0;
/// m and rad of a move that counts. Chosen: nearly half of what `calibrate --apply` drives.
inline constexpr double kLeastProofWay_m = 0.45, kLeastProofTurn_rad = 0.9 * std::numbers::pi;

}  // namespace odomcalib::writeback::settings
