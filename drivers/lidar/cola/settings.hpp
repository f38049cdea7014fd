// Numbers that decide about SICK lidars.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

#include <cstddef>
#include <cstdint>

namespace odomcalib::drivers::cola {

// Dialogue.
/// s for an answer in one dialect, before the other is tried. Chosen: answers take 10 ms, but
/// not while a device starts.
inline constexpr double kDialect_s = 1.0;
/// s for any other answer. Chosen as above, for a device that has spoken already.
inline constexpr double kPatience_s = 0.5;
/// s until the state is asked for again. Chosen: starting takes seconds.
inline constexpr double kPause_s = 0.5;
/// s until the first scan; s without one. Derived: 15 turns of the slowest model (15 Hz), twice that at
/// first.
inline constexpr double kFirstScan_s = 2.0, kNoScan_s = 1.0;

// Telegrams.
/// Bytes of one. Derived: 8192 values of two bytes in two channels, and more than any model sends.
inline constexpr std::size_t kMostBytes = std::size_t{64} * 1024;
/// Published (SICK, telegram listing): three encoders, five echoes with their strengths and two of angles.
inline constexpr unsigned kMostEncoders = 3, kMostChannels = 12;
/// Layers of a sensor that are told apart. Chosen: MRS6000 has 24; a bound on memory.
inline constexpr unsigned kMostLayers = 32;
/// Values of a channel. Chosen: more than any supported model has.
inline constexpr unsigned kMostValues = 8192;
/// Degrees. Derived: a turn and some overlap.
inline constexpr double kMostSpan_deg = 400.0;
/// 1/100 Hz. Chosen: no model turns slower than 0.1 Hz or faster than 1 kHz.
inline constexpr std::uint32_t kSlowest_chz = 10, kFastest_chz = 100'000;

// Ranges and dates.
/// Raw values below are codes: no echo, dazzled, implausible. Published (SICK, telegram listing).
inline constexpr unsigned kFirstDistance = 16;
/// m. Chosen: below what any model measures; codes mark what is not a reading. Published: LMS5xx reaches 80
/// m.
inline constexpr double kRangeMin_m = 0.01, kRangeMax_m = 80.0;
/// s from the end of a sweep to "time since start" of models that send before a sweep's length has passed
/// since it. Measured on LMS111 and TiM: 0 to 3 ms.
inline constexpr double kUntilEnd_s = 1.5e-3;

}  // namespace odomcalib::drivers::cola
