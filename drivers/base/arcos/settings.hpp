// Numbers that decide about ARCOS bases.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

namespace odomcalib::drivers::arcos {

/// s between two keep-alives. Derived: a quarter of the usual watchdog of 2 s.
inline constexpr double kPulse_s = 0.5;

}  // namespace odomcalib::drivers::arcos
