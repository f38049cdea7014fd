// How an error of the ranges is looked for while a map is made: whether there is one is decided elsewhere.
#pragma once

#include <functional>
#include <vector>

#include "calib/measurement/adjust.hpp"
#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::measurement {

struct PlacedBeams {
  std::vector<std::vector<Beam>> beams;  ///< of each scan
  std::vector<Place> places;
};

struct RangeTrace {
  std::vector<terms::LidarFinding> findings;  ///< an offset, a dependence on incidence, or both
  double offset = 0.0;                        ///< m, to be taken out of every range
  WallMap map;                                ///< as it is without the offset
};

/// The map was adjusted to `used` with `options`, which left `evidence`; `others` are scans between those.
using RangeTracer =
    std::function<RangeTrace(const RangeEvidence& evidence, const PlacedBeams& used,
                             const PlacedBeams& others, const PlaceOptions& options, const WallMap& map)>;

}  // namespace odomcalib::calib::measurement
