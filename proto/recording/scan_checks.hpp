// Conditions that a scan must meet before anything else sees it. Internal to proto/.
#pragma once

#include <cstddef>

#include "proto/measurements.hpp"

namespace odomcalib {

/// Why a scan cannot be used, or nullptr. Its time stamp is not looked at.
const char* scan_problem(const Scan& scan);

struct BeamProblems {
  std::size_t not_a_number = 0;
  std::size_t out_of_limits = 0;
};

/// Turns ranges that are no distance into 0 ("no reading") and counts them; replaces impossible limits and
/// increments by "unknown"; lists beams that state their angles and times in order of time; a lidar that
/// states no range_max gets its farthest reading.
BeamProblems clean_scan(Scan& scan);

}  // namespace odomcalib
