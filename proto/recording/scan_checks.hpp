// Conditions that a scan must meet before anything else sees it.
#pragma once

#include <cstddef>
#include <string>

#include "proto/measurements.hpp"

namespace odomcalib {

/// Why a scan cannot be used, or nullptr. Its time stamp is not looked at.
const char* scan_problem(const Scan& scan);

/// A unit of length that is no metre.
struct RangeUnit {
  const char* name;
  double size;  ///< m
};

struct BeamProblems {
  std::size_t not_a_number = 0;
  std::size_t out_of_limits = 0;
  /// The unit that the ranges are likely in, where all of a scan lie beyond the limits; else null.
  const RangeUnit* unit = nullptr;
};

/// The unit that the reason of a discarded beam names; null for every other reason.
const RangeUnit* range_unit_of_reason(const std::string& reason);
/// Reason of a discarded beam whose range lies outside the limits.
std::string reason_outside_limits(const RangeUnit* unit);

/// Lists the beams the other way round; stamp and times stay.
void list_backwards(Scan& scan);

/// A negative time_increment says that the last beam was sent first: lists the beams the other way round,
/// from the time of that one on.
void list_first_sent_first(Scan& scan);

/// Turns ranges that are no distance into 0 ("no reading") and counts them; replaces impossible limits and
/// increments by "unknown"; lists beams that state their angles and times in order of time; a lidar that
/// states no range_max gets its farthest reading.
BeamProblems clean_scan(Scan& scan);

}  // namespace odomcalib
