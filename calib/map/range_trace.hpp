// Looks for an error of the ranges in a map of walls, and proves it on scans that the map was not adjusted
// to.
#pragma once

#include <vector>

#include "calib/lidar/lidar_trace.hpp"
#include "calib/map/adjust.hpp"

namespace odomcalib::calib {

struct PlacedBeams {
  std::vector<std::vector<Beam>> beams;  ///< of each scan
  std::vector<Place> places;
};

struct RangeTrace {
  std::vector<LidarFinding> findings;  ///< an offset, a dependence on incidence, or both
  double offset = 0.0;                 ///< m, to be taken out of every range
  WallMap map;                         ///< as it is without the offset
};

/// @param map adjusted to `used` with `options`
/// @param evidence of that adjustment
/// @param others scans between those, in their places
RangeTrace trace_ranges(const RangeEvidence& evidence, const PlacedBeams& used, const PlacedBeams& others,
                        const PlaceOptions& options, const WallMap& map);

}  // namespace odomcalib::calib
