// Scans of which nobody said when within them each beam was sent.
#pragma once

#include <span>
#include <vector>

#include "proto/recording/recording.hpp"

namespace odomcalib::calib::ingest {

/// The recordings with beams sent one after the other by a head that turns once from scan to scan, as most
/// do; whether this one does, motion has to say. Empty where any recording states times of beams, has no
/// scans, or those of several sensors.
std::vector<Recording> with_sweeps(std::span<const Recording> recordings);

/// Of the head, s, by scans that sweep; negative where it turns clockwise.
double turn_of_head(const Recording& sweeping);

/// A stamp is that of the first beam. Where there is a delay anyway, let it be the delay of the sweep's
/// middle, as it would be of scans taken for instants.
void take_stamps_for_middles(std::vector<Recording>& recordings);

}  // namespace odomcalib::calib::ingest
