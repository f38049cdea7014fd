// How far back the last stop lies.
#pragma once

#include <array>

namespace odomcalib::calib::vehicle {

/// s; how long a robot has to stand until something sticks is not known either. Shorter stops are reversals.
inline constexpr std::array<double, 14> kStops = {0.12,  0.14, 0.155, 0.17, 0.19, 0.21, 0.23,
                                                  0.255, 0.28, 0.31,  0.34, 0.37, 0.41, 0.45};
using SinceStop = std::array<double, kStops.size()>;

class Standstill {
 public:
  Standstill();
  /// @param relative_speed of the rims of late, in units of the least that is no standing
  /// @param dt s
  void arrive(double relative_speed, double dt);
  /// @param way m, mean of the two rims in the interval
  void leave(double way);
  /// s; 0 while it moves
  [[nodiscard]] double stood() const { return stood_; }
  /// It moves again in this interval, after it had stood.
  [[nodiscard]] bool sets_off() const { return sets_off_; }
  /// Way since it last stood still for each of kStops, m.
  [[nodiscard]] const SinceStop& since() const { return since_; }

 private:
  double relative_speed_ = 0.0;
  double stood_ = 0.0;  ///< s
  bool sets_off_ = false;
  SinceStop since_{};
};

}  // namespace odomcalib::calib::vehicle
