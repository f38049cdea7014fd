// Segway RMP: CAN, 11 bit, big-endian words. Read only: no command time-out of the device is documented, so
// it is never enabled. Source: Segway RMP interface guide.
#pragma once

#include "drivers/base/speed/speed_protocol.hpp"

namespace odomcalib::drivers {

class Segway final : public SpeedProtocol {
 public:
  explicit Segway(const Profile& /*profile*/) {}

  [[nodiscard]] Wire wire() const override { return Wire::can; }
  void on_frame(const CanFrame& frame) override;
  void greet(double /*now*/) override {}
  void command(double /*left_rad_s*/, double /*right_rad_s*/) override {}
  [[nodiscard]] Counters counters() const override;

  static const std::vector<WireMessage>& messages();

 private:
  std::uint64_t frames_in_ = 0, frames_used_ = 0, bad_frames_ = 0, other_frames_ = 0;
};

}  // namespace odomcalib::drivers
