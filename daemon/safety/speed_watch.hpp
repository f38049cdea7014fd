// Rule M7 on what is measured: whoever makes the robot faster than it may be, this program or another.
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "daemon/routines/motion.hpp"

namespace odomcalib::safety {

class SpeedWatch {
 public:
  /// @param limits of the motion, at most the caps
  explicit SpeedWatch(const routines::Limits& limits) : limits_(routines::capped(limits)) {}

  /// Odometry at a reading of the counts; one that is not newer than the last tells nothing.
  /// @param t s, by the clock of the readings
  void seen(double t, const routines::Pose& odometry);
  /// How much faster the robot was than it may be, over the last fifth of a second.
  [[nodiscard]] std::optional<std::string> too_fast() const;

 private:
  struct Sample {
    double t;
    routines::Pose pose;
  };
  routines::Limits limits_;
  std::deque<Sample> samples_;  // the oldest is the newest that is older than the window
};

}  // namespace odomcalib::safety
