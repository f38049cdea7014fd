// Scans of which nobody said when within them each beam was sent, and which part of a turn a
// scan covers.
#pragma once

#include <optional>

#include "calib/ingest/recordings.hpp"
#include "proto/measurements.hpp"

namespace odomcalib::calib::ingest {

/// The recordings with beams sent one after the other by a head that turns once from scan to scan, as most
/// do; whether this one does, motion has to say. The report states the sweep. Nothing where any recording
/// states times of beams, has no scans, or those of several sensors.
std::optional<Recordings> with_sweeps(const Recordings& recordings);

/// A stamp is that of the first beam. Where there is a delay anyway, let it be the delay of the sweep's
/// middle, as it would be of scans taken for instants.
Recordings stamped_in_the_middle(const Recordings& sweeping);

/// Whether scans cover (nearly) a whole turn, and state no more than that.
bool sees_all_round(const Scan& scan);
/// Whether the stated steps of all beams add up to more than a turn: no head has two beams in one direction.
bool overstates_a_turn(const Scan& scan);

}  // namespace odomcalib::calib::ingest
