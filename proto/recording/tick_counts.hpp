// Cumulative counts as controllers send them: wrapping, resetting, jumping. Internal to proto/.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "proto/measurements.hpp"

namespace odomcalib {

struct ContinuedCounts {
  std::size_t breaks = 0;                              ///< new segments
  std::size_t jumps = 0;                               ///< of them, those that the samples did not carry
  std::optional<std::int64_t> modulus = std::nullopt;  ///< at which both counters wrap, where it is no width
  std::size_t misread = 0;  ///< samples that were taken for what lies between their neighbours
};

/// Unwraps counts of 16 and 32 bits, takes single samples that were read wrong for what lies between their
/// neighbours, and starts a new segment wherever a count cannot be continued: after a
/// reset, or after a step that no wheel can have made. Counts inside a segment differ by real motion only.
/// Expects samples sorted by time with increasing stamps; samples that carry different segments already are
/// never joined.
/// @param robot nominal geometry: turns counts into speeds; zero fields: only wraps and resets to zero are
/// recognised
ContinuedCounts continue_counts(std::vector<TickSample>& ticks, const RobotDescription& robot);

}  // namespace odomcalib
