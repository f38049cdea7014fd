// All walls and all poses at once: the map that fits every reading of a recording best. The poses are
// eliminated one by one (Schur complement), so that the system is as large as the walls are many.
#pragma once

#include <functional>
#include <vector>

#include "calib/measurement/localise.hpp"
#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::measurement {

/// Gauss-Newton on shift and turn of each wall and on all poses; the first pose stays where it is.
/// @param scans beams of each scan
/// @param places where they were taken; updated
/// @return what the ranges would have to be wrong by, beyond `options.range_error`, to fit better still
RangeEvidence adjust_map(const std::vector<std::vector<Beam>>& scans, const PlaceOptions& options,
                         WallMap& map, std::vector<Place>& places);

struct PlacedBeams {
  std::vector<std::vector<Beam>> beams;  ///< of each scan
  std::vector<Place> places;
};

struct RangeTrace {
  std::vector<terms::LidarFinding> findings;  ///< an offset, a dependence on incidence, or both
  double offset = 0.0;                        ///< m, to be taken out of every range
  WallMap map;                                ///< as it is without the offset
};

/// How an error of the ranges is looked for while a map is made; whether there is one is decided elsewhere.
/// The map was adjusted to `used` with `options`, which left `evidence`; `others` are scans between those.
using RangeTracer =
    std::function<RangeTrace(const RangeEvidence& evidence, const PlacedBeams& used,
                             const PlacedBeams& others, const PlaceOptions& options, const WallMap& map)>;

}  // namespace odomcalib::calib::measurement
