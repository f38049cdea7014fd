// How the reference moved, without a word from the wheels: for a first look at recordings whose counts, clock
// or units may be wrong.
#pragma once

#include <cstddef>
#include <vector>

#include "calib/math/se2.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::measurement {

struct ReferenceMotion {
  double begin = 0.0, end = 0.0;  ///< s, on the clock of the reference
  math::Pose motion;              ///< of the sensor (poses: of the base), in its frame at the begin
};

struct ReferenceMotions {
  std::vector<ReferenceMotion> motions;    ///< of about kFirstLookStep_s each, in order of time
  std::size_t matched = 0, unmatched = 0;  ///< neighbouring scans
};

/// Scans are matched one after the other, each from the motion before; poses are taken as they are.
/// @param most scans or poses that are looked at, from the begin
ReferenceMotions reference_motions(const Recording& recording, std::size_t most);

}  // namespace odomcalib::calib::measurement
