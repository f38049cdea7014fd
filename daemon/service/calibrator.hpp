// What the daemon needs of calib, as functions: the loop is tested without solving anything.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "daemon/routines/motion.hpp"
#include "proto/calibration.hpp"
#include "proto/recording.hpp"

namespace odomcalib {

struct Calibrator {
  using Progress = std::function<void(const std::string& phase, double fraction)>;
  using Odometry = std::function<PoseSample(const TickSample&)>;

  /// Runs in a thread of its own.
  std::function<Calibration(const std::vector<Recording>&, const std::vector<std::string>& effects,
                            const Progress&)>
      solve;
  std::function<Odometry(const Calibration&)> odometry;
  /// Motion of the base between two scans taken at rest; nullopt when the match is no good. May be empty.
  std::function<std::optional<routines::Pose>(const Scan& from, const Scan& to, const routines::Pose& guess,
                                              const std::array<double, 3>& lidar_pose)>
      match;
};

/// Everything from calib.
Calibrator make_calibrator();

}  // namespace odomcalib
