#include "calib/ingest/scan_span.hpp"

#include <cmath>
#include <cstddef>

#include "calib/ingest/settings.hpp"
#include "calib/math/se2.hpp"

namespace odomcalib::calib::ingest {
namespace {

/// Angle from one beam to the next in the mean, rad; 0 with less than two.
double mean_step(const Scan& scan) {
  if (scan.ranges.size() < 2) return 0.0;
  double swept = 0.0;  // angles that are stated beam by beam may start again at half a turn
  for (std::size_t k = 1; k < scan.ranges.size(); ++k)
    swept += math::wrap_angle(scan.angle(k) - scan.angle(k - 1));
  return std::abs(swept) / static_cast<double>(scan.ranges.size() - 1);
}

}  // namespace

bool overstates_a_turn(const Scan& scan) {
  const double step = mean_step(scan);
  return step * static_cast<double>(scan.ranges.size()) >= 2.0 * math::kPi + 0.5 * step;
}

bool sees_all_round(const Scan& scan) {
  return mean_step(scan) * static_cast<double>(scan.ranges.size()) > settings::kAllRoundScan_rad &&
         !overstates_a_turn(scan);
}

}  // namespace odomcalib::calib::ingest
