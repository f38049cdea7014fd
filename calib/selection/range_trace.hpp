// Looks for an error of the ranges in a map of walls, and cross-validates it on scans that the map was not
// adjusted to.
#pragma once

#include "calib/measurement/adjust.hpp"
#include "calib/selection/rules.hpp"

namespace odomcalib::calib::selection {

/// @param map adjusted to `used` with `options`
/// @param evidence of that adjustment
/// @param others scans between those, in their places
/// @param rules all of them but in an ablation
measurement::RangeTrace trace_ranges(const measurement::RangeEvidence& evidence,
                                     const measurement::PlacedBeams& used,
                                     const measurement::PlacedBeams& others,
                                     const measurement::PlaceOptions& options,
                                     const measurement::WallMap& map, const RuleSet& rules = {});

}  // namespace odomcalib::calib::selection
