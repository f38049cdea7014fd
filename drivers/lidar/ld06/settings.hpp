// Numbers that decide about LDROBOT lidars.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

#include "drivers/lidar/common/sweep.hpp"

namespace odomcalib::drivers::ld06 {

/// m. Published (data sheets): LD06, LD19, STL-19P; STL-27L.
inline constexpr Sweep::Limits kLimits{0.02, 12.0, true};
inline constexpr Sweep::Limits kLongLimits{0.02, 25.0, true};
/// Points a second, above which the long limits hold. Chosen.
inline constexpr double kLongFrom_hz = 5000.0;
/// s. Derived: the stamp is cut off to whole milliseconds, half of one is lost on average.
inline constexpr double kHalfStamp_s = 0.5e-3;
/// Gains of the filter that smooths the stamp's steps of 1 ms. Chosen: 20 packets are 50 ms; the rate follows
/// a motor over some seconds.
inline constexpr double kPhaseGain = 0.05, kPeriodGain = 0.0005;
/// s that a stamp may be off before the stream has a hole. Chosen: seven packets, three degrees of a turn.
inline constexpr double kResync_s = 0.02;

}  // namespace odomcalib::drivers::ld06
