// Rule M7 on what is measured: whoever makes the robot faster than it may be, or than it is commanded to be,
// this program or another.
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

  /// Odometry at a reading of the counts; one that is not newer than the last says nothing.
  /// @param t s, by the clock of the readings @param commanded at the same time
  void seen(double t, const routines::Pose& odometry, const routines::Twist& commanded);
  /// How much faster the robot was over the last fifth of a second than it may be, or than any command since
  /// a little before.
  [[nodiscard]] std::optional<std::string> too_fast() const;

 private:
  struct Sample {
    double t;
    routines::Pose pose;
  };
  struct Command {
    double t, speed, rate;  // magnitudes
  };
  routines::Limits limits_;
  std::deque<Sample> samples_;    // the oldest is the newest that is older than the window
  std::deque<Command> commands_;  // those of the window, and of the drive's lag before it
};

}  // namespace odomcalib::safety
