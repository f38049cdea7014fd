// Numbers that decide about YDLIDAR.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

#include <cstddef>
#include <cstdint>

namespace odomcalib::drivers::ydlidar {

// Dialogue.
/// s after a stop, until what was under way has arrived. Chosen: a packet of 40 samples takes 8 ms at 115200.
inline constexpr double kQuiet_s = 0.05;
/// s for an answer. Chosen: answers take 3 ms; a USB adapter adds 16.
inline constexpr double kPatience_s = 0.25;
/// s for the first measurement; s without measurements. Chosen: a motor spins up in 1 s.
inline constexpr double kSpinUp_s = 2.0, kSilence_s = 1.0;

// Packets.
/// Bytes of an answer. Chosen: the longest known has 20.
inline constexpr std::size_t kMostAnswerBytes = 64;
/// Samples of a packet. Published (manuals): 40, newer models 80.
inline constexpr unsigned kMostSamples = 128;
/// m. Chosen: the least and the longest of the family (TG50 and T30 stay below); not checked on devices.
inline constexpr double kRangeMin_m = 0.05, kRangeMax_m = 64.0;
/// Wrong checksums without one right packet that are another model. Chosen: a fraction of a second; a noisy
/// line has right ones among them.
inline constexpr std::uint64_t kAllWrong = 50;
/// Packets among these that are right with samples of the other size. Derived: chance gives one in 65536.
inline constexpr std::uint64_t kOtherKind = 2;

}  // namespace odomcalib::drivers::ydlidar
