#include "calib/slam/keyframes.hpp"

#include <cmath>

namespace odomcalib::calib::slam {

std::vector<std::size_t> choose_keyframes(std::span<const math::Pose> odometry,
                                          const KeyframeSpacing& spacing) {
  std::vector<std::size_t> chosen;
  double travel = 0.0, turn = 0.0;
  for (std::size_t k = 0; k < odometry.size(); ++k) {
    if (k > 0) {
      const math::Pose step = between(odometry[k - 1], odometry[k]);
      travel += std::hypot(step.x, step.y);
      turn += std::abs(math::wrap_angle(step.yaw));
    }
    // A hair below the limit counts: sums of many steps are not exact.
    const bool far = travel > spacing.distance - 1e-9 || turn > spacing.rotation - 1e-9;
    if (!chosen.empty() && !far) continue;
    chosen.push_back(k);
    travel = turn = 0.0;
  }
  return chosen;
}

}  // namespace odomcalib::calib::slam
