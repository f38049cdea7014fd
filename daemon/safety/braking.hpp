// Rule M5: how far a drive goes on beyond its command when it brakes, as it was measured.
#pragma once

#include <deque>
#include <optional>

#include "daemon/routines/motion.hpp"

namespace odomcalib::safety {

class Braking {
 public:
  /// A motion begins: what came before it was none of its stops.
  void begins();
  /// Odometry at a reading of the counts; one that is not newer than the last says nothing.
  /// @param t s, by the clock of the readings @param commanded at the same time
  void seen(double t, const routines::Pose& odometry, const routines::Twist& commanded);
  /// s: way beyond the command over the speed from which it braked, the longest of the newest stops. What the
  /// drive's lag and a weaker deceleration than commanded add to the stopping distance v t_react + v^2 / (2
  /// a) is v times this. 0 before the first stop from a driving speed.
  [[nodiscard]] double overrun() const;

 private:
  struct Stop {
    double speed;           // m/s, from which the command fell
    double commanded, way;  // m, since then
  };
  void end(const Stop& stop);

  std::optional<double> t_;
  routines::Pose pose_;
  double fastest_ = 0.0;  // m/s, commanded since the last stop
  double last_ = 0.0;     // m/s, commanded
  double steady_ = 0.0;   // s, of a command that stays
  std::optional<Stop> stop_;
  double resting_ = 0.0;  // s
  std::deque<double> overruns_;
};

}  // namespace odomcalib::safety
