// Messages that are parts of one scan: how a part goes on where the one before ended.
#pragma once

#include <cstddef>
#include <vector>

#include "proto/measurements.hpp"

namespace odomcalib {

/// Relative difference of the steps from beam to beam of two parts whose bearings are stated beam by beam.
/// Chosen: the speed of a head wanders by some per cent.
inline constexpr double kSameStepOfParts = 0.1;
/// Steps, by which the first beam of a part may miss the one after the last beam of the part before. Chosen:
/// half a step, and rounding.
inline constexpr double kNextBeamOfParts = 0.6;

/// rad from beam to beam in the mean, negative for a clockwise lidar; 0 of a single beam with a bearing.
double mean_step(const Scan& scan);

/// Appends each scan that has the stamp of the one before and goes on where that ended, up to a whole turn.
/// @param scans in order of time
/// @return how many were appended
std::size_t join_parts_of_one_stamp(std::vector<Scan>& scans);

}  // namespace odomcalib
