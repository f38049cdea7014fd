// What the time of a term is in another drive than the one that it was fitted to.
#pragma once

#include <optional>

#include "proto/calibration/calibration.hpp"

namespace odomcalib::calib::odometry {

/// Wheels that warm up or leak change with the time since the calibration's own drive began. A drive that
/// begins on the same clock, during that one or no longer after its end than it took, finds the wheels as
/// they were at that moment, and later as they were at the end: how they went on nobody measured. When any
/// other drive begins, nobody knows how warm they are: they count by the middle of the calibration's drive.
class DriveClock {
 public:
  DriveClock() = default;
  /// @param stamp of the first ticks of the drive, s
  DriveClock(const Calibration& calibration, double stamp);
  [[nodiscard]] bool is_known() const { return begin_.has_value(); }
  /// @return s since the beginning of the calibration's drive, from zero to its duration
  [[nodiscard]] double at(double stamp) const;

 private:
  double duration_ = 0.0;
  std::optional<double> begin_;  ///< of the calibration's drive, where its clock is also that of this one
};

}  // namespace odomcalib::calib::odometry
