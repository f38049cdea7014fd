#include "daemon/service/agreement.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "daemon/safety/envelope.hpp"
#include "daemon/service/dead_reckoning.hpp"
#include "daemon/service/settings.hpp"

namespace odomcalib {
namespace {

bool beyond(const routines::Pose& moved, double way, double turn) {
  return std::hypot(moved.x, moved.y) > way || std::abs(moved.yaw) > turn;
}

}  // namespace

bool AgreementWatch::due(const routines::Pose& odometry) const {
  using namespace service::settings;
  return open_ || beyond(relative(judged_at_, odometry), kJudgedWay_m, kJudgedTurn_rad);
}

void AgreementWatch::seen(const Scan& scan, const routines::Pose& odometry, const Calibrator& calibrator,
                          const std::array<double, 3>& lidar_pose) {
  if (!calibrator.match) return;
  if (!reference_) {
    reference_ = {scan, odometry, {}};
    judged_at_ = odometry;
    return;
  }
  if (!due(odometry)) return;
  auto seen = calibrator.match(reference_->scan, scan, relative(reference_->odometry, odometry), lidar_pose);
  // Odometry that is far from the truth is no guess: swapped sides turn the wrong way.
  if (!seen) seen = calibrator.match(reference_->scan, scan, {}, lidar_pose);
  if (seen)
    judge(scan, odometry, *seen);
  else
    unjudged(odometry);
}

void AgreementWatch::unjudged(const routines::Pose& odometry) {
  using namespace service::settings;
  open_ = true;
  const auto moved = relative(judged_at_, odometry);
  if (!beyond(moved, kUnjudgedWay_m, kUnjudgedTurn_rad)) return;
  disagreement_ = fmt::format(
      "the lidar cannot judge the motion, for {:.2f} m and {:.0f} deg by now: it needs walls in sight on all "
      "sides, not a corridor or an empty hall",
      std::hypot(moved.x, moved.y), std::abs(moved.yaw) * 180.0 / std::numbers::pi);
}

void AgreementWatch::judge(const Scan& scan, const routines::Pose& odometry, const routines::Pose& seen) {
  using namespace service::settings;
  const auto moved = relative(reference_->odometry, odometry);
  const auto why = safety::disagreement(moved, seen);
  // One bad match must not stop the robot; two in a row are a fact. The second judge is the next scan.
  disagreements_ = why ? disagreements_ + 1 : 0;
  if (disagreements_ >= kDisagreements) disagreement_ = why;
  open_ = why.has_value();
  judged_at_ = odometry;
  if (why) return;
  motion_ = composed(reference_->motion, seen);
  if (beyond(moved, kComparedWay_m, kComparedTurn_rad)) reference_ = {scan, odometry, motion_};
}

}  // namespace odomcalib
