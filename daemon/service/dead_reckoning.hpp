// Odometry with the parameters in force: what a routine is controlled by. The corrected odometry is calib's.
#pragma once

#include <deque>
#include <optional>

#include "daemon/routines/motion.hpp"
#include "proto/measurements.hpp"

namespace odomcalib {

/// Motion between two samples.
struct Increment {
  double forward = 0.0;  ///< m
  double turn = 0.0;     ///< rad
};
/// With the parameters in force; nullopt across segments, and where the geometry is unknown.
std::optional<Increment> increment_between(const TickSample& from, const TickSample& to,
                                           const RobotDescription& robot);

class DeadReckoning {
 public:
  /// Adds the motion since the last sample; a new segment or an unknown geometry adds none.
  void add(const TickSample& sample, const RobotDescription& robot);
  /// yaw is continuous over full turns.
  [[nodiscard]] const routines::Pose& pose() const { return pose_; }
  /// Where it was at this time, between two samples of the last second; before and after them, where they
  /// end.
  /// @param t s, by the clock of the samples
  [[nodiscard]] routines::Pose at(double t) const;

 private:
  struct Past {
    double t;
    routines::Pose pose;
  };
  std::optional<TickSample> last_;
  routines::Pose pose_;
  std::deque<Past> past_;  // oldest first
};

/// Half way between the first and the last beam, s; the first, where the scan does not say how long it took.
double middle_of(const Scan& scan);

/// `pose` in the frame of `start`; yaw difference continuous.
routines::Pose relative(const routines::Pose& start, const routines::Pose& pose);
/// `b`, a pose in the frame of `a`, in the frame that `a` is in.
routines::Pose composed(const routines::Pose& a, const routines::Pose& b);

}  // namespace odomcalib
