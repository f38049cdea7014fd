// Messages that are parts of one scan and carry its stamp. Internal to proto/.
#pragma once

#include <cstddef>
#include <vector>

#include "proto/measurements.hpp"

namespace odomcalib {

/// Relative difference of the steps from beam to beam of two parts. Chosen: where bearings are stated beam by
/// beam, the speed of a head wanders by some per cent.
inline constexpr double kSameStepOfParts = 0.1;
/// Steps, by which the first beam of a part may miss the one after the last beam of the part before. Chosen,
/// untried.
inline constexpr double kNextBeamOfParts = 0.6;

/// Appends each scan that has the stamp of the one before and goes on where that ended, up to a whole turn.
/// @param scans in order of time
/// @return how many were appended
std::size_t join_parts_of_one_stamp(std::vector<Scan>& scans);

}  // namespace odomcalib
