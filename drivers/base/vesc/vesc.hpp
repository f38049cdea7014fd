// Two VESC motor controllers on one CAN bus: 29-bit identifier = command << 8 | controller, big-endian.
// Source: open firmware (bldc), comm_can.c and commands.c.
//
// The motor is released a fixed time after the last command (1 s as delivered). The tachometer counts 6 steps
// an electrical turn, so counts_per_rev = 6 x pole pairs x gear, and electrical rpm = wheel rpm x
// counts_per_rev / 6.
#pragma once

#include <array>

#include "drivers/base/speed/speed_protocol.hpp"
#include "drivers/base/vesc/buffer.hpp"

namespace odomcalib::drivers {

class Vesc final : public SpeedProtocol {
 public:
  explicit Vesc(const Profile& profile) : profile_(profile) {}

  [[nodiscard]] Wire wire() const override { return Wire::can; }
  void on_frame(const CanFrame& frame) override;
  void greet(double now) override;
  void command(double left_rad_s, double right_rad_s) override;
  void release() override;
  [[nodiscard]] Counters counters() const override;

  static const std::vector<WireMessage>& messages();
  /// GET_MCCONF_TEMP's answer: motor poles, gear ratio, wheel diameter.
  static const WireMessage& configuration();

 private:
  void on_status(Side side, std::uint32_t command, const CanFrame& frame);
  void on_buffer(std::uint32_t command, const CanFrame& frame);
  void on_packet(const std::vector<std::uint8_t>& packet, double t);
  void send_to(std::uint8_t node, std::uint32_t command, std::int64_t value);

  const Profile profile_;
  vesc::ReceiveBuffer buffer_;
  std::uint64_t frames_in_ = 0, frames_used_ = 0, bad_frames_ = 0, other_frames_ = 0, bad_packets_ = 0;
};

}  // namespace odomcalib::drivers
