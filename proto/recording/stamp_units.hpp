// Time stamps that are no seconds: what they look like.
#pragma once

#include <cstddef>
#include <string>

#include "proto/result.hpp"

namespace odomcalib {

/// s since 1970, of dates that a stamp may show: the years 2001 to 2065. Chosen; units of time are a factor
/// of 1000 apart, so that no stamp fits two of them.
inline constexpr double kEarliestDate_s = 1e9, kLatestDate_s = 3e9;

/// Share of messages or samples with the stamp of the one before, of stamps that have lost their last digits.
/// Chosen: of a stream that two programs recorded together half of them repeat themselves, in stamp and
/// value.
inline constexpr double kRepeatedShare = 0.6;

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
