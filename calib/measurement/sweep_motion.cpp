#include "calib/measurement/sweep_motion.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/measurement/settings.hpp"

namespace odomcalib::calib::measurement {
namespace {

/// Poses at equal steps of time.
struct Knots {
  std::vector<math::Pose> poses;
  double step = 0.0;  ///< s

  [[nodiscard]] math::Pose at(double seconds) const {
    const double place = std::clamp(seconds / step, 0.0, static_cast<double>(poses.size() - 1));
    const auto k = std::min(static_cast<std::size_t>(place), poses.size() - 2);
    const double share = place - static_cast<double>(k);
    const math::Pose &a = poses[k], &b = poses[k + 1];
    return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.yaw + share * (b.yaw - a.yaw)};
  }
};

}  // namespace

matching::BeamMotion motion_in_sweep(const vehicle::Trajectory& trajectory, const math::Pose& mount,
                                     const Scan& scan) {
  const double middle = matching::reference_time(scan);
  if (!(middle > 0.0)) return [](double) { return math::Pose{}; };
  const auto sensor_at = [&](double seconds) { return compose(trajectory.at(scan.t + seconds), mount); };
  const math::Pose origin = sensor_at(middle);
  const double steps = std::ceil(2.0 * middle / settings::kSweepSpacing_s);
  Knots knots;
  knots.step = 2.0 * middle / steps;
  for (double k = 0.0; k <= steps; ++k) knots.poses.push_back(between(origin, sensor_at(k * knots.step)));
  return [knots = std::move(knots)](double seconds) { return knots.at(seconds); };
}

}  // namespace odomcalib::calib::measurement
