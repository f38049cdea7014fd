// When the robot drove. Member `driven` of the calibration file; it follows from `data`.
#pragma once

#include <optional>
#include <string>

#include "proto/calibration/calibration.hpp"

namespace odomcalib {

struct Driven {
  double begin = 0.0, end = 0.0;  ///< s since 1970, UTC, of the first and of the last counts
};

/// nullopt where a recording has no begin, or stamps that count from elsewhere than 1970.
std::optional<Driven> driven_of(const Calibration& calibration);

/// "2026-11-29T10:19:45Z", whole seconds, as ISO 8601 has it.
std::string iso_time(double time);
/// "2026-11-29, 10:19 to 10:24 UTC" for people; both days where the drives began and ended on two.
std::string readable_time(const Driven& driven);

}  // namespace odomcalib
