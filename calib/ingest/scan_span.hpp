// Which part of a turn a scan covers.
#pragma once

#include "proto/measurements.hpp"

namespace odomcalib::calib::ingest {

/// Whether scans cover (nearly) a whole turn, and state no more than that.
bool sees_all_round(const Scan& scan);
/// Whether the stated steps of all beams add up to more than a turn: no head has two beams in one direction.
bool overstates_a_turn(const Scan& scan);

}  // namespace odomcalib::calib::ingest
