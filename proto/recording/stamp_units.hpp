// Time stamps that are no seconds: what they look like.
#pragma once

#include <cstddef>
#include <string>

#include "proto/result.hpp"

namespace odomcalib {

/// Unit in which a stamp beyond any clock in seconds would be a date of this century: "milliseconds since
/// 1970", "microseconds since 1970" or "nanoseconds since 1970"; null where it is none.
const char* unit_of_date(double stamp);

/// Reason of a discarded sample with such a stamp.
std::string stamp_reason(const char* unit);

/// The unit that such a reason names; empty for every other reason.
std::string unit_of_reason(const std::string& reason);

/// Error about samples that were left out for such a stamp.
/// @param what of the discarded samples: "ticks", "scan", "pose"
Error wrong_dates(const std::string& what, std::size_t count, const std::string& unit,
                  const std::string& where);

}  // namespace odomcalib
