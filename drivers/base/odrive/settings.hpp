// Numbers that decide about ODrive.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

namespace odomcalib::drivers::odrive {

/// s between two questions for counts. Chosen: counts at 100 Hz as from other controllers.
inline constexpr double kAsk_s = 0.01;
/// Turns above which positions are coarse. Derived: a 32-bit float resolves 1/4096 turn only below this.
inline constexpr double kFineTurns = 2048.0;
/// Turns above which a number is no position. Chosen: 100,000 km.
inline constexpr double kMostTurns = 1e9;

}  // namespace odomcalib::drivers::odrive
