// Interruptions of a reference.
#pragma once

#include <cstddef>
#include <vector>

namespace odomcalib::calib::ingest {

/// Beyond this time between neighbouring scans or poses, s, the reference was interrupted.
inline constexpr double kMaxGap = 2.0;

/// @param times s, in time order
bool has_gap(const std::vector<double>& times, std::size_t from, std::size_t to);

}  // namespace odomcalib::calib::ingest
