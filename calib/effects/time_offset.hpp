// Scans stamped at the end of the sweep or at reception, encoder counts stamped late: a constant delay
// between the clocks.
//
// A scan stamped t was taken at encoder time t - offset. To first order the motion in an interval changes by
// -offset (v(end) - v(begin), 0, w(end) - w(begin)): visible only while the speed changes.
#pragma once

#include <memory>

#include "calib/model/effect.hpp"

namespace odomcalib::calib {

std::shared_ptr<const Effect> make_time_offset();

}  // namespace odomcalib::calib
