// Looks for errors of the lidar itself before any term of the wheels is scored, and takes them out of the
// scans.
#pragma once

#include <vector>

#include "calib/measurement/heading_pairs.hpp"
#include "calib/terms/lidar_effect.hpp"
#include "calib/terms/lidar_finding.hpp"

namespace odomcalib::calib::selection {

/// Stepwise: the best candidate is added while it is beyond chance, larger than negligible and lessens the
/// disagreement of scans it was not fitted to.
/// @param all_round whether the head sees all directions
/// @param ranges_are_judged a map, which sees them better, has shown what there is of an offset or of
/// incidence
std::vector<terms::LidarFinding> trace_lidar(const std::vector<measurement::HeadingPair>& pairs,
                                             bool all_round, bool ranges_are_judged = false);

/// Values of given effects, whether they are significant or not.
std::vector<terms::LidarFinding> fit_lidar(const std::vector<measurement::HeadingPair>& pairs,
                                           const std::vector<terms::LidarEffectPtr>& effects);

}  // namespace odomcalib::calib::selection
