// Numbers that decide about boards with ros_arduino_bridge.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

#include <cstddef>

namespace odomcalib::drivers::ros_arduino {

/// s between two questions for counts. Chosen: below the firmware's control interval of 33 ms, which is what
/// counts can change with.
inline constexpr double kAsk_s = 0.02;
/// s until an answer is given up. Derived: the firmware answers within its control interval of 33 ms.
inline constexpr double kAnswer_s = 0.25;
/// Bytes of a line. Derived: two 32-bit numbers have 23; anything longer is noise.
inline constexpr std::size_t kLongestLine = 64;

}  // namespace odomcalib::drivers::ros_arduino
