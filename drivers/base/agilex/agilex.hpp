// AgileX chassis (Scout, Tracer, Bunker, Hunter), protocol V2: CAN, 11 bit, big-endian, no checksum.
// Source: AgileX user manuals, open driver ugv_sdk.
#pragma once

#include "drivers/base/speed/speed_protocol.hpp"

namespace odomcalib::drivers {

class Agilex final : public SpeedProtocol {
 public:
  explicit Agilex(const Profile& profile) : profile_(profile) {}

  [[nodiscard]] Wire wire() const override { return Wire::can; }
  void on_frame(const CanFrame& frame) override;
  void greet(double now) override;
  void engage() override;
  void command(double left_rad_s, double right_rad_s) override;
  void release() override;
  [[nodiscard]] DeviceState device_state() const override { return state_; }
  [[nodiscard]] Counters counters() const override;

  static const std::vector<WireMessage>& messages();

 private:
  void on_state(const DeviceMessage& message);
  void on_motor(std::uint32_t motor, DeviceMessage& message);
  void on_odometer(const DeviceMessage& message);
  void send_bytes(std::uint32_t id, std::span<const std::uint8_t> data);

  const Profile profile_;
  DeviceState state_;
  std::uint64_t frames_in_ = 0, frames_used_ = 0, bad_frames_ = 0, other_frames_ = 0;
};

}  // namespace odomcalib::drivers
