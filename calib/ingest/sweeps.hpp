// Scans of which nobody said when within them each beam was sent, and which part of a turn a
// scan covers.
#pragma once

#include <optional>

#include "calib/ingest/recordings.hpp"
#include "proto/measurements.hpp"

namespace odomcalib::calib::ingest {

/// The recordings with beams sent by a head of that kind; whether it is, motion has to say. The report states
/// the sweep, and by how much a turn of it takes longer than what was stated. Nothing where any recording has
/// a time for each beam, no scans, or those of several sensors, or where times are stated and of the kind
/// they are not, or the other way round.
std::optional<Recordings> with_sweeps(const Recordings& recordings, SweepKind kind = SweepKind::assumed);

/// A stamp is that of the first beam. Where there is a delay anyway, let it be the delay of the sweep's
/// middle, as it would be of scans taken for instants.
Recordings stamped_in_the_middle(const Recordings& sweeping);

/// Whether scans cover (nearly) a whole turn, and state no more than that.
bool sees_all_round(const Scan& scan);
/// Whether the stated steps of all beams add up to more than a turn: no head has two beams in one direction.
bool overstates_a_turn(const Scan& scan);

}  // namespace odomcalib::calib::ingest
