// Dates process data that a drive sends on its own timer. A host that was held up reads them late, several at
// once and all with the same time; but the drive went on sending at its even intervals. What arrives in time
// keeps its date, what comes later than usual is dated by the interval.
#pragma once

#include "drivers/sample_clock.hpp"

namespace odomcalib::drivers {

class TimerDates {
 public:
  /// @param period_s nominal, s; the true one is learnt
  explicit TimerDates(double period_s) : period_s_(period_s) {}

  /// @param arrival s on the caller's clock
  /// @return when it was sent, never later than the arrival
  double date(double arrival);
  void forget() { clock_.reset(); }

 private:
  double period_s_;
  SampleClock clock_{false};
  double usual_ = 0.0;  // s behind the earliest, smoothed
};

}  // namespace odomcalib::drivers
