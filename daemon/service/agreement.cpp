#include "daemon/service/agreement.hpp"

#include <cmath>

#include "daemon/safety/envelope.hpp"
#include "daemon/service/dead_reckoning.hpp"
#include "daemon/service/settings.hpp"

namespace odomcalib {

void AgreementWatch::seen(const Scan& scan, const routines::Pose& odometry, const Calibrator& calibrator,
                          const std::array<double, 3>& lidar_pose) {
  if (!calibrator.match) return;
  const auto moved = reference_ ? relative(reference_pose_, odometry) : routines::Pose{};
  const bool judge = std::hypot(moved.x, moved.y) > service::settings::kComparedWay_m ||
                     std::abs(moved.yaw) > service::settings::kComparedTurn_rad;
  if (reference_ && !judge) return;
  if (reference_) {
    auto seen = calibrator.match(*reference_, scan, moved, lidar_pose);
    // Odometry that is far from the truth is no guess: swapped sides turn the wrong way.
    if (!seen) seen = calibrator.match(*reference_, scan, {}, lidar_pose);
    const auto why = seen ? safety::disagreement(moved, *seen) : std::nullopt;
    // One bad match must not stop the robot; two in a row are a fact. The second judge is the next scan.
    disagreements_ = why ? disagreements_ + 1 : 0;
    if (disagreements_ >= service::settings::kDisagreements) disagreement_ = why;
    if (why) return;
  }
  reference_ = scan;
  reference_pose_ = odometry;
}

}  // namespace odomcalib
