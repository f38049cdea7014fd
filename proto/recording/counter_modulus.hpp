// Counters that wrap at a number of their own: the counts of one turn, degrees, hall steps. Internal to
// proto/.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "proto/measurements.hpp"

namespace odomcalib {

/// The number at which both counters start again, where their jumps agree on one; nothing where there are no
/// jumps, where these are no wraps, or where they do not tell the number to the last count. Wraps of 16 and
/// 32 bits need no such evidence, and are left to continue_counts.
std::optional<std::int64_t> counter_modulus(const std::vector<TickSample>& ticks);

}  // namespace odomcalib
