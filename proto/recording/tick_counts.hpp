// Cumulative counts as controllers send them: wrapping, resetting, jumping. Internal to proto/.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "proto/measurements.hpp"
#include "proto/recording/counter_modulus.hpp"

namespace odomcalib {

struct ContinuedCounts {
  std::size_t breaks = 0;                  ///< new segments
  std::size_t jumps = 0;                   ///< of them, those that the samples did not carry
  std::array<CounterModulus, 2> moduli{};  ///< at which the left and the right counter wrap by themselves
  std::size_t misread = 0;                 ///< samples that were taken for what lies between their neighbours
};

/// Unwraps counts of 16 and 32 bits and those that wrap at a number of their own, takes single samples that
/// were read wrong for what lies between their neighbours, and starts a new segment wherever a count cannot
/// be continued: after a reset, or after a step that no wheel can have made. Counts inside a segment differ
/// by real motion only. Expects samples sorted by time with increasing stamps; samples that carry different
/// segments already are never joined.
/// @param robot nominal geometry: turns counts into speeds; zero fields: only wraps and resets to zero are
/// recognised
ContinuedCounts continue_counts(std::vector<TickSample>& ticks, const RobotDescription& robot);

}  // namespace odomcalib
