// The metre of a reference: lengths follow it, and no motion of the robot shows whether it is one.
#pragma once

#include <optional>
#include <span>

#include "calib/ingest/recordings.hpp"
#include "proto/calibration/scale.hpp"

namespace odomcalib::calib::ingest {

/// Of a lidar of which nobody said more: as its data sheet has it. nullopt of other references, whose metre
/// is whoever's measured them.
std::optional<Scale> scale_by_data_sheet(std::span<const Recording> recordings);

/// Lengths of the reference (ranges and their limits, x and y of poses and of motions) multiplied by the
/// scale; of a scale of one the recordings given.
Recordings with_scale(std::span<const Recording> given, double scale);

}  // namespace odomcalib::calib::ingest
