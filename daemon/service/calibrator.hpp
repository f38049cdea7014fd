// Functions of calib that the daemon needs: the loop is tested without solving anything.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "daemon/routines/motion.hpp"
#include "proto/calibration/calibration.hpp"
#include "proto/calibration/value_check.hpp"
#include "proto/recording/recording.hpp"
#include "proto/result.hpp"

namespace odomcalib {

/// A value of a calibration that is no wheel dimension, and where it takes effect.
struct HostValue {
  std::string name;  ///< backlash.left_play
  Quantity quantity;
  std::string applied_in;  ///< for people
};

/// A motion worth driving after a calibration, and why.
struct NextManoeuvre {
  std::string name;
  std::string why;
};

struct Calibrator {
  using Progress = std::function<void(const std::string& phase, double fraction)>;
  using Odometry = std::function<PoseSample(const TickSample&)>;

  using Solve = std::function<Result<Calibration>(const std::vector<std::filesystem::path>& recordings,
                                                  const std::vector<std::string>& effects, const Progress&)>;

  /// Solves the recordings of one robot, jointly. Runs in a thread of its own. An exception from its progress
  /// report ends it.
  Solve solve;
  /// Why effects of these names cannot be fitted. May be empty: any name is taken then.
  std::function<std::optional<Error>(const std::vector<std::string>&)> wrong_effects;
  std::function<Odometry(const Calibration&)> odometry;
  /// May be empty: units of effects are not looked at then.
  UnitOfEffect unit_of_effect;
  /// May be empty: no progress is reported then.
  std::function<std::vector<HostValue>(const Calibration&)> host_values;
  std::function<std::optional<NextManoeuvre>(const Calibration&)> next_manoeuvre;
  /// Motion of the base between two scans taken at rest; nullopt when the match is no good. May be empty.
  std::function<std::optional<routines::Pose>(const Scan& from, const Scan& to, const routines::Pose& guess,
                                              const std::array<double, 3>& lidar_pose)>
      match;
};

/// Everything from calib.
Calibrator make_calibrator();

}  // namespace odomcalib
