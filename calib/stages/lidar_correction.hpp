// Errors of the lidar show between scans, before any term of the wheels is scored; they are taken out of the
// scans.
#pragma once

#include <vector>

#include "calib/estimation/fit.hpp"
#include "calib/measurement/placement.hpp"
#include "calib/selection/rules.hpp"
#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::stages {

struct LidarCorrection {
  estimation::Fit fit;                             ///< to the scans without what was found
  std::vector<terms::LidarFinding> findings = {};  ///< also those that cannot be taken out
  measurement::Placement placement = {};  ///< made on the way; perhaps of scans before their correction
};

/// First wrong angles; then wrong ranges, in a map of walls; then the others, and these too where there is no
/// map, in pairs of scans. A correction that nobody requested and that the wheels contradict is rejected.
/// @param request names errors that are fitted whether they are significant or not; automatic: looked for
/// @param rules all of them but in an ablation
LidarCorrection correct_lidar(estimation::Fit fit, const terms::Request& request,
                              const estimation::Settling& how, const selection::RuleSet& rules = {});

}  // namespace odomcalib::calib::stages
