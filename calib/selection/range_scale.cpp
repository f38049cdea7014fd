#include "calib/selection/range_scale.hpp"

#include <cmath>
#include <cstddef>

#include "calib/selection/settings.hpp"

namespace odomcalib::calib::selection {
namespace {

/// Of all errors that are left in the scans.
double slope(const std::vector<terms::LidarFinding>& findings, double bearing, double range) {
  const double step = settings::kHalfStep * range;
  double rise = 0.0;
  for (const terms::LidarFinding& finding : findings) {
    if (finding.effect->is_correctable()) continue;
    const auto error = [&](double r) { return finding.effect->total({bearing, r}, finding.values).radial; };
    rise += error(range + step) - error(range - step);
  }
  return rise / (2.0 * step);
}

}  // namespace

double range_scale_uncertainty(const std::vector<terms::LidarFinding>& findings,
                               std::span<const Recording> recordings) {
  double squares = 0.0, count = 0.0;
  for (const Recording& recording : recordings)
    for (std::size_t s = 0; s < recording.scans.size();
         s += 1 + recording.scans.size() / settings::kScansOfScale) {
      const Scan& scan = recording.scans[s];
      for (std::size_t k = 0; k < scan.ranges.size(); ++k) {
        const auto range = static_cast<double>(scan.ranges[k]);
        if (!(range > 0.0)) continue;
        const double own = slope(findings, scan.angle(k), range);
        squares += own * own;
        ++count;
      }
    }
  return count > 0.0 ? 0.5 * std::sqrt(squares / count) : 0.0;
}

}  // namespace odomcalib::calib::selection
