// When the counts in a drive's process data were taken, the same for the driver and for `decode`.
#pragma once

#include <optional>

#include "drivers/base/canopen/pdo.hpp"
#include "drivers/base/motion/timer_dates.hpp"
#include "drivers/base/profile/profile.hpp"

namespace odomcalib::drivers {

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
