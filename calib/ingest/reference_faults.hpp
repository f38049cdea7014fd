// Faults of the reference, and of the counts beside it, that can be undone. Internal to calib/ingest: see
// put_right.hpp.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/math/se2.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::ingest {

inline constexpr double kWholeTurn = 2.0 * math::kPi;  ///< rad

/// Without the samples that are marked, which are listed as discarded; nothing where none is.
/// @param lost what and why; its numbers are counted here
template <typename Sample>
std::optional<Recording> without_marked(const Recording& recording, std::vector<Sample> Recording::*stream,
                                        Discarded lost, const std::vector<bool>& marked) {
  if (std::find(marked.begin(), marked.end(), true) == marked.end()) return std::nullopt;
  const std::vector<Sample>& samples = recording.*stream;
  lost.of = samples.size();
  Recording rest = recording;
  (rest.*stream).clear();
  for (std::size_t k = 0; k < marked.size(); ++k) {
    if (marked[k])
      count_one(lost, samples[k].t);
    else
      (rest.*stream).push_back(samples[k]);
  }
  rest.discarded.push_back(std::move(lost));
  return rest;
}

/// Scans of one sensor only, where there are several; nothing where there is one.
/// @param sensor the one; empty: that with most scans
std::optional<Recording> of_one_sensor(const Recording& recording, const std::string& sensor);

/// Whole turns, where each scan goes on where the one before ended; nothing where scans are no parts of
/// turns.
std::optional<Recording> with_joined_turns(const Recording& recording);

/// Without counts of times in which one of them stands still, as that of a broken encoder, while the other
/// wheel rolls farther than a robot turns about one wheel; nothing without any, or where one never changes.
std::optional<Recording> without_dead_counts(const Recording& recording);

/// Without scans or poses that equal the one before in every number although the wheels turned; nothing
/// without any.
std::optional<Recording> without_repeated_scans(const Recording& recording);
std::optional<Recording> without_repeated_poses(const Recording& recording);

/// Beams spread over one turn by their number, where their number varies and their stated step does not;
/// nothing where both agree.
std::optional<Recording> with_whole_turns(const Recording& recording);

/// The same, with word_on_unused_scans() among its repairs; nothing where there is none.
std::optional<Recording> with_unused_scans_told(const Recording& recording);

}  // namespace odomcalib::calib::ingest
