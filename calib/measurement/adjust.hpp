// All walls and all poses at once: the map that fits every reading of a recording best. The poses are
// eliminated one by one (Schur complement), so that the system is as large as the walls are many.
#pragma once

#include <vector>

#include "calib/measurement/localise.hpp"

namespace odomcalib::calib::measurement {

/// Gauss-Newton on shift and turn of each wall and on all poses; the first pose stays where it is.
/// @param scans beams of each scan
/// @param places where they were taken; updated
/// @return what the ranges would have to be wrong by, beyond `options.range_error`, to fit better still
RangeEvidence adjust_map(const std::vector<std::vector<Beam>>& scans, const PlaceOptions& options,
                         WallMap& map, std::vector<Place>& places);

}  // namespace odomcalib::calib::measurement
