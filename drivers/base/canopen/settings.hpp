// Numbers that decide about SDO transfers.
// Origin: derived (from what), published (where), measured (on what), or chosen (why this and not another).
#pragma once

#include <cstddef>

namespace odomcalib::drivers::canopen {

/// s until an answer is overdue. Published: CiA 301 leaves it open; the usual default of masters is 0.5 to 1
/// s.
inline constexpr double kSdoTimeout_s = 0.5;
/// Bytes of a segmented transfer. Chosen: names are the longest objects that are read; a bound on memory.
inline constexpr std::size_t kSdoMostBytes = 1024;

}  // namespace odomcalib::drivers::canopen
