#include "calib/terms/lidar_finding.hpp"

#include <algorithm>

namespace odomcalib::calib::terms {

bool completes(const LidarFinding& finding, const std::vector<LidarFinding>& all) {
  return !finding.effect->is_named() && std::any_of(all.begin(), all.end(), [&](const LidarFinding& other) {
    return other.effect->is_named() && other.effect->covariate() == finding.effect->covariate();
  });
}

Scan corrected(const Scan& scan, const std::vector<LidarFinding>& findings) {
  Scan out = scan;
  out.angles.resize(scan.ranges.size());
  for (std::size_t k = 0; k < scan.ranges.size(); ++k) {
    const auto range = static_cast<double>(scan.ranges[k]);
    double angle = scan.angle(k);
    double true_range = range;
    for (const LidarFinding& finding : findings) {
      if (!finding.effect->is_correctable()) continue;
      const BeamShift shift = finding.effect->total({scan.angle(k), range}, finding.values);
      true_range -= shift.radial;
      angle -= shift.angular;
    }
    out.angles[k] = static_cast<float>(angle);
    if (range > 0.0) out.ranges[k] = static_cast<float>(std::max(true_range, 0.0));
  }
  return out;
}

}  // namespace odomcalib::calib::terms
