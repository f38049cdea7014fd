// An error of the lidar itself that was found in its scans, and the scans without it.
#pragma once

#include <vector>

#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::terms {

struct LidarFinding {
  LidarEffectPtr effect;
  std::vector<double> values, deviations;  ///< in the order of effect->parameters()
  double family_p_value = 1.0;
  double before = 0.0, after = 0.0;  ///< m, RMS distance between scans on pairs that were not fitted
};

/// Whether a finding is the rest of another's function and no finding of its own.
bool completes(const LidarFinding& finding, const std::vector<LidarFinding>& all);

/// The scan as it would be without the errors found.
Scan corrected(const Scan& scan, const std::vector<LidarFinding>& findings);

}  // namespace odomcalib::calib::terms
