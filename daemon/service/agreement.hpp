// Rule M9: odometry and lidar must agree while the robot drives, and what the lidar cannot judge is no
// agreement.
#pragma once

#include <optional>
#include <string>

#include "daemon/service/calibrator.hpp"

namespace odomcalib {

class AgreementWatch {
 public:
  /// Compares the newest scan with an earlier one, every tenth of a metre or 30 degrees.
  /// @param odometry in the middle of the scan
  /// @param calibrator its `match` judges; without one nothing is compared
  void seen(const Scan& scan, const routines::Pose& odometry, const Calibrator& calibrator,
            const std::array<double, 3>& lidar_pose);
  /// How the two differ, or how far the robot has come without a match, once that is certain.
  [[nodiscard]] const std::optional<std::string>& disagreement() const { return disagreement_; }
  /// Motion since the first scan, as the lidar saw it at the last comparison; yaw continuous over full turns.
  [[nodiscard]] const routines::Pose& motion() const { return motion_; }

 private:
  /// The earlier scan.
  struct Reference {
    Scan scan;
    routines::Pose odometry;
    routines::Pose motion;  ///< since the first one, by lidar
  };
  [[nodiscard]] bool due(const routines::Pose& odometry) const;
  void unjudged(const routines::Pose& odometry);
  void judge(const Scan& scan, const routines::Pose& odometry, const routines::Pose& seen);

  std::optional<Reference> reference_;
  routines::Pose judged_at_;  // odometry, at the last comparison
  routines::Pose motion_;
  std::optional<std::string> disagreement_;
  int disagreements_ = 0;  // in a row
  bool open_ = false;  // the last attempt found no match, or a disagreement: the next scan is the next try
};

}  // namespace odomcalib
