// Looks for errors of the lidar itself before any term of the wheels is scored, and takes them out of the
// scans.
#pragma once

#include <span>
#include <vector>

#include "calib/measurement/heading_pairs.hpp"
#include "calib/selection/rules.hpp"
#include "calib/terms/lidar_effect.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::selection {

/// Stepwise: the best candidate is added while it is beyond chance, larger than negligible and lessens the
/// disagreement of scans it was not fitted to.
/// @param all_round whether the head sees all directions
/// @param ranges_are_judged a map, which sees them better, has shown what there is of an offset or of
/// incidence
/// @param rules all of them but in an ablation
std::vector<terms::LidarFinding> trace_lidar(const std::vector<measurement::HeadingPair>& pairs,
                                             bool all_round, bool ranges_are_judged = false,
                                             const RuleSet& rules = {});

/// Values of given effects, whether they are significant or not.
std::vector<terms::LidarFinding> fit_lidar(const std::vector<measurement::HeadingPair>& pairs,
                                           const std::vector<terms::LidarEffectPtr>& effects);

/// Standard deviation, relative, of a length that was measured with scans in which errors of the range were
/// left: half the RMS of their slope, d(error)/d(range), over what the scans see, so that one as large as the
/// slope is two deviations off. Which part of the slope is a common scale no scan shows.
/// @param findings those that scans are corrected by do not count
double range_scale_uncertainty(const std::vector<terms::LidarFinding>& findings,
                               std::span<const Recording> recordings);

}  // namespace odomcalib::calib::selection
