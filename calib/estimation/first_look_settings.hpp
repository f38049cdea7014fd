// Numbers that decide in a first look, each once, with its unit and its origin: derived (from what),
// published (source), measured (where), chosen (for what reason).
#pragma once

#include <cstddef>

namespace odomcalib::calib::estimation::settings {

/// Scans or poses that are looked at. Chosen: half a minute to ten minutes, by the reference's rate.
inline constexpr std::size_t kMostLookedAt = 3000;
/// The same while each of several mistakes is tried on the scans. Chosen: a minute at 10 Hz.
inline constexpr std::size_t kMostTried = 600;
/// Motions of half a second that a judgement takes. Chosen.
inline constexpr std::size_t kFewestMotions = 20;
/// Share of the reference's rotation that the counts explain: below the first they contradict it, above the
/// second they agree. Measured: sound simulated recordings have 0.93 to 0.99, clocks apart by seconds 0 to
/// 0.4.
inline constexpr double kContradicts = 0.75, kAgrees = 0.9;
/// Of the unexplained rotation, what a mistake put right may leave. Chosen: no small gain names a mistake.
inline constexpr double kLeftOver = 0.4;
/// s, step and reach of the search for a delay. Chosen: people start recorders within a minute of each other.
inline constexpr double kDelayStep_s = 0.1, kDelayReach_s = 60.0;
/// Relative difference of the lengths of two streams that may be one of their clocks' rates. Chosen.
inline constexpr double kSpansApart = 0.05;
/// Counts that a wheel may fall by and still count up only: an edge seen twice.
inline constexpr int kEdge = 2;
/// Share of the motions in which counts with a direction explain the rotation plainly better, of counts that
/// have none. Chosen: now and then a match fails.
inline constexpr double kAgainstCounting = 0.05;

}  // namespace odomcalib::calib::estimation::settings
