// Rule M9: odometry and lidar must agree while the robot drives.
#pragma once

#include <optional>
#include <string>

#include "daemon/service/calibrator.hpp"

namespace odomcalib {

class AgreementWatch {
 public:
  /// Compares the newest scan with one from a quarter of a metre or 30 degrees before.
  /// @param calibrator its `match` judges; without one nothing is compared
  void seen(const Scan& scan, const routines::Pose& odometry, const Calibrator& calibrator,
            const std::array<double, 3>& lidar_pose);
  /// How the two differ, once that is certain.
  [[nodiscard]] const std::optional<std::string>& disagreement() const { return disagreement_; }

 private:
  std::optional<Scan> reference_;
  routines::Pose reference_pose_;
  std::optional<std::string> disagreement_;
  int disagreements_ = 0;  // in a row
};

}  // namespace odomcalib
