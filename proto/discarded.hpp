// Parts of a recording that were left out, put right or chosen: evidence that every stage hands on.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "proto/number_text.hpp"

namespace odomcalib {

/// Something that was not used, and why.
struct Discarded {
  std::string what;    ///< e.g. "scan", "line", "event", "interval"
  std::string reason;  ///< e.g. "cut off", "out of order by more than 1 s", "unknown fingerprint 0x..."
  std::size_t count = 0;
  std::size_t of = 0;                          ///< how many of them there were; 0: not known
  std::optional<double> begin = std::nullopt;  ///< s, of the first one; none where they have no time
  std::optional<double> end = std::nullopt;    ///< s, of the last one
  std::size_t copies = 0;                      ///< of the count, what said the same as what was kept
};

/// Widens the time in which they lie.
/// @param t s
inline void include(Discarded& discarded, double t) {
  discarded.begin = std::min(discarded.begin.value_or(t), t);
  discarded.end = std::max(discarded.end.value_or(t), t);
}

/// One more of them.
/// @param t s
inline void count_one(Discarded& discarded, double t) {
  ++discarded.count;
  include(discarded, t);
}

/// Name of a repair that rests on a measurement, not on what the recording states.
inline constexpr const char* kRepairedClock = "clock";

/// Something that was put right, or taken where there were several.
struct Repair {
  std::string what;    ///< e.g. "times", "joints", "frame", "turns"
  std::string chosen;  ///< what is used
  std::string reason;  ///< what of the recording speaks for it
};

/// Stamps of one stream that step against those of another: each side of the step gets its own offset.
/// @param by s, positive where the clock was set ahead
/// @param when s, with "about" where it is not seen
/// @param set whose clock it was: "their clock was set"
inline Repair repaired_clock(const std::string& whose, double by, const std::string& when,
                             const std::string& against, const std::string& set) {
  std::string reason = "stamps of the " + whose + " step by " + printed("%.2f", by) + " s at " + when;
  reason += " s against those of the " + against + ": " + set;
  return {kRepairedClock, "each side of the step with its own offset", std::move(reason)};
}

}  // namespace odomcalib
