// Looks for errors of the lidar itself before any wheel is asked, and takes them out of the scans.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/lidar/heading_pairs.hpp"
#include "calib/lidar/lidar_effect.hpp"

namespace odomcalib::calib {

struct LidarFinding {
  LidarEffectPtr effect;
  std::vector<double> values, deviations;  ///< in the order of effect->parameters()
  double family_p_value = 1.0;
  double before = 0.0, after = 0.0;  ///< m, RMS distance between scans on pairs that were not fitted
};

/// Whether a finding is the rest of another's law and no finding of its own.
bool completes(const LidarFinding& finding, const std::vector<LidarFinding>& all);

/// Stepwise: the best candidate is added while it is beyond chance, larger than negligible and lessens the
/// disagreement of scans it was not fitted to.
/// @param all_round whether the head sees all directions
/// @param ranges_are_judged a map, which sees them better, has shown what there is of an offset or of
/// incidence
std::vector<LidarFinding> trace_lidar(const std::vector<HeadingPair>& pairs, bool all_round,
                                      bool ranges_are_judged = false);

/// Values of given effects, whether they are significant or not.
std::vector<LidarFinding> fit_lidar(const std::vector<HeadingPair>& pairs,
                                    const std::vector<LidarEffectPtr>& effects);

/// The scan as it would be without the errors found.
Scan corrected(const Scan& scan, const std::vector<LidarFinding>& findings);

/// Whether scans cover (nearly) a whole turn, and state no more than that.
bool sees_all_round(const Scan& scan);
/// Whether the stated steps of all beams add up to more than a turn: no head has two beams in one direction.
bool overstates_a_turn(const Scan& scan);

}  // namespace odomcalib::calib
