// Left-out parts of a recording, in words: the same in every verb.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "proto/discarded.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib {

/// Name of what lies between two samples of counts.
inline constexpr const char* kInterval = "interval";

/// Whether the file ends in it: whatever followed is gone, and nobody knows how much that was.
bool is_end_of_file(const Discarded& one);

/// Gives what the file ends in the time of the last sample that could be read.
void tell_where_it_ends(Recording& recording);

/// Left-out parts of a recording, with ways between counts by their own name.
std::vector<Discarded> left_out_of(const Recording& recording);

/// Whether what is gone may be missed: not what a lidar does not see, what is there in a finer form, or what
/// belongs to somebody else.
bool is_loss(const Discarded& one);

/// A loss of what the motion of the wheels is computed from.
bool is_loss_of_motion(const Discarded& one);

/// Share of what there was, without copies of what was kept; 0 where that is not known.
double share_of(const Discarded& one);

/// "363 of 1916 intervals between counts (19 %), from 3.2 to 71 s: REASON"; "the file from 71 s on: cut off"
/// @param start s, of the recording: times are told from there on
std::string to_text(const Discarded& one, std::optional<double> start);

}  // namespace odomcalib
