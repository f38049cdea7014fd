// Numbers that decide how a write-back waits and what is kept of it, each once, with its unit and its origin:
// derived (from what), or chosen (for what reason; where none is given, no comparison with other values is
// known).
#pragma once

#include <cstddef>
#include <cstdint>

namespace odomcalib::writeback::settings {

/// s that a reset node's rest may take to be known. Chosen: it is known only when counts have come for a
/// while.
inline constexpr double kWaitForRest_s = 2.0;
/// s for a controller that is configured anew, on the way back to the old values. Chosen: boot and
/// configuration take one.
inline constexpr double kWaitForController_s = 5.0;
/// Entries of the history. Chosen.
inline constexpr std::size_t kKeptEntries = 50;
/// Bytes of a journal from which a new one begins. Chosen.
inline constexpr std::uintmax_t kRotateAt_bytes = std::uintmax_t{1} << 20;

}  // namespace odomcalib::writeback::settings
