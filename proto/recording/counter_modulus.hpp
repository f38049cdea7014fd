// Counters that wrap at a number of their own: the counts of one turn, degrees, hall steps. Internal to
// proto/.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "proto/measurements.hpp"

namespace odomcalib {

/// Number at which one counter wraps, as its jumps tell it.
struct CounterModulus {
  std::int64_t modulus = 0;  ///< counts, where the counter starts again; 0: not known
  /// Steps are so long that only the step before tells how often the counter has wrapped.
  bool is_fast = false;
  /// Counts, about where the counter starts again, where the samples do not tell it safely; 0: no sign of it.
  std::int64_t suspected = 0;
  double jump = 0.0;  ///< counts; longer steps hold a wrap, where one is suspected
};

/// For the left and the right counter the number at which it wraps, where its jumps agree on one; nothing
/// where there are no jumps, or where these are no wraps. Where they do not tell the number, or tell it and
/// not how often it is passed from sample to sample, the number is suspected only. Wraps of 16 and 32 bits
/// need no such evidence, and are left to continue_counts.
std::array<CounterModulus, 2> counter_moduli(const std::vector<TickSample>& ticks);

/// Step of a fast counter, or of one across lost samples: the one that is nearest to what is expected.
std::int64_t nearest_step(std::int64_t difference, std::int64_t modulus, double expected);

}  // namespace odomcalib
