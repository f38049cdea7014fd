// ODrive CANSimple, two axes: CAN, 11-bit identifier = node << 5 | command, little-endian.
// Source: ODrive CAN protocol documentation.
#pragma once

#include <array>

#include "drivers/base/speed/speed_protocol.hpp"

namespace odomcalib::drivers {

class Odrive final : public SpeedProtocol {
 public:
  explicit Odrive(const Profile& profile) : profile_(profile) {}

  [[nodiscard]] Wire wire() const override { return Wire::can; }
  void on_frame(const CanFrame& frame) override;
  void greet(double /*now*/) override {}
  void ask(double now) override;
  void engage() override;
  void command(double left_rad_s, double right_rad_s) override;
  void release() override;
  [[nodiscard]] DeviceState device_state() const override;
  [[nodiscard]] Counters counters() const override;

  static const std::vector<WireMessage>& messages();

 private:
  struct Axis {
    std::optional<double> state;
    double error = 0.0;
  };
  void on_message(Side side, const DeviceMessage& message);
  void to_both(std::uint32_t command, std::span<const std::uint8_t> data);
  void send_to(std::uint8_t node, std::uint32_t command, std::span<const std::uint8_t> data,
               bool remote = false);

  const Profile profile_;
  std::array<Axis, 2> axes_;
  double ask_due_ = 0.0;
  std::uint64_t frames_in_ = 0, frames_used_ = 0, bad_frames_ = 0, other_frames_ = 0, coarse_ = 0;
};

}  // namespace odomcalib::drivers
