// Ticks whose stamps are uneven although they were sampled evenly.
#pragma once

#include <optional>

#include "calib/ingest/even_stamps.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::ingest {

/// Even stamps of the ticks, where counts grow steadily by number and not by stamp; nothing where the stamps
/// are right, or where the wheels hardly turn. Counts that were sent twice get the same stamp.
std::optional<EvenStamps> even_ticks(const Recording& recording);

}  // namespace odomcalib::calib::ingest
