// Interruptions of a reference.
#pragma once

#include <cstddef>
#include <vector>

namespace odomcalib::calib::ingest {

/// @param times s, in time order
bool has_gap(const std::vector<double>& times, std::size_t from, std::size_t to);

}  // namespace odomcalib::calib::ingest
