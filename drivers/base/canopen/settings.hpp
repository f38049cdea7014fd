// Numbers that decide about SDO transfers.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

#include <cstddef>

namespace odomcalib::drivers::canopen {

/// s until an answer is overdue. Published: CiA 301 leaves it open; the usual default of masters is 0.5 to 1
/// s.
inline constexpr double kSdoTimeout_s = 0.5;
/// s after which nothing of what was sent before can come any more. Derived: a request and its answer may
/// each be late by a time-out.
inline constexpr double kSdoSettles_s = 2.0 * kSdoTimeout_s;
/// Bytes of a segmented transfer. Chosen: names are the longest objects that are read; a bound on memory.
inline constexpr std::size_t kSdoMostBytes = 1024;

}  // namespace odomcalib::drivers::canopen
