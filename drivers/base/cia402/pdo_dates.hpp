// When the counts in a drive's process data were taken, the same for the driver and for `decode`.
#pragma once

#include <optional>

#include "drivers/base/canopen/pdo.hpp"
#include "drivers/base/profile/profile.hpp"
#include "drivers/device_clock.hpp"

namespace odomcalib::drivers {

/// Dates process data that a drive sends on its own timer. A host that was held up reads them late, several
/// at once and all with the same time; but the drive went on sending at its even intervals. What arrives in
/// time keeps its date, what comes later than usual is dated by the interval.
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

class PdoDates {
 public:
  explicit PdoDates(const Profile& profile)
      : bitrate_(profile.bitrate), timer_unit_s_(1e-3 * profile.heartbeat_unit_ms) {}

  /// A SYNC ended.
  void on_sync(double t) { sync_at_ = t; }
  /// Data on SYNC were sampled at its end, others when the frame began; those on the drive's timer keep its
  /// beat. To be called for the frames that hold counts, in their order.
  double date(const canopen::Pdo& pdo, const CanFrame& frame);
  /// The drive is gone: its timer begins anew.
  void forget() { timer_.reset(); }

 private:
  double bitrate_;       // bit/s
  double timer_unit_s_;  // of an event timer
  std::optional<double> sync_at_;
  std::optional<TimerDates> timer_;
};

}  // namespace odomcalib::drivers
