// Numbers that decide about profiles.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

namespace odomcalib::drivers {

/// s, longest command time-out of a device that is still taken for a watchdog. Chosen: the slowest shipped
/// controllers (ARCOS, ros_arduino) wait so long.
inline constexpr double kLongestWatchdog_s = 2.0;

}  // namespace odomcalib::drivers
