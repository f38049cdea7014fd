// Numbers that decide about Hokuyo lidars.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

#include <cstddef>

namespace odomcalib::drivers::scip {

// Dialogue.
/// s of silence after QT: then nothing is under way any more. Chosen: a turn of 100 ms, and what
/// the line still holds.
inline constexpr double kSilence_s = 0.14;
/// s; a sensor that will not be silent is asked all the same. Chosen: ten times that.
inline constexpr double kMostQuiet_s = 1.5;
/// s for an answer. Chosen: replies take 5 ms, on a serial line of 19200 baud up to 0.2 s.
inline constexpr double kPatience_s = 0.3;
/// s after a refusal. Chosen: motors take seconds to spin up.
inline constexpr double kPause_s = 0.5;
/// s for the first scan; s without one. Chosen as for other lidars.
inline constexpr double kSpinUp_s = 2.0, kNoScan_s = 1.0;

/// Bytes of a reply. Derived: three echoes with intensity of 1440 steps stay below.
inline constexpr std::size_t kMostReplyBytes = std::size_t{64} * 1024;
/// Steps a turn. Chosen: ten times what any model has.
inline constexpr unsigned kMostSteps = 100'000;

}  // namespace odomcalib::drivers::scip
