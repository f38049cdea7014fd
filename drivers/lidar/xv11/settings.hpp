// Numbers that decide about the Neato XV-11.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

#include "drivers/lidar/common/sweep.hpp"

namespace odomcalib::drivers::xv11 {

/// m. Measured by its users: nothing sensible outside.
inline constexpr Sweep::Limits kLimits{0.06, 6.0, true};
/// Turns a minute. Chosen: twice what the unit is built for.
inline constexpr double kFastest_rpm = 600.0;

}  // namespace odomcalib::drivers::xv11
