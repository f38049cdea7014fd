// Numbers that decide about controllers that take wheel speeds.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

namespace odomcalib::drivers::speed {

/// s between two greetings of a device that does not answer. Chosen: found within 2 s after it is switched
/// on.
inline constexpr double kGreet_s = 0.3;
/// s until a device that was asked for its settings must have told them. Derived: 100 bytes at 9600 baud take
/// 0.1 s, in a stream of others.
inline constexpr double kSettings_s = 1.0;
/// s of standing counts that are rest. Derived: four periods of the slowest board (33 ms), and one to spare.
inline constexpr double kRest_s = 0.15;
/// s between two looks at a motion that is not wanted. Derived: the command cycle.
inline constexpr double kIdle_s = 0.02;

}  // namespace odomcalib::drivers::speed
