// Pioneer, PeopleBot and AmigoBot bases (ARCOS) on a serial line.
// Source: Pioneer 3 operations manual, open library ARIA.
//
// The firmware computes a pose of its own from TicksMM, RevCount and DriftFactor. This program uses raw
// encoder counts (packet 90h), so that those never enter a calibration; they are read and shown. Their steps
// (TicksMM 132: 0.76 %) are too coarse to hold one, and only the vendor's tool can store them: the
// calibration stays on the host.
#pragma once

#include "drivers/base/arcos/packet.hpp"
#include "drivers/base/speed/speed_protocol.hpp"

namespace odomcalib::drivers {

class Arcos final : public SpeedProtocol {
 public:
  explicit Arcos(const Profile& profile) : profile_(profile) {}

  [[nodiscard]] Wire wire() const override { return Wire::serial; }
  void on_connected(std::optional<unsigned> baud) override;
  void on_bytes(std::span<const std::uint8_t> bytes, double now) override;
  void greet(double now) override;
  void ask(double now) override;
  void engage() override;
  void command(double left_rad_s, double right_rad_s) override;
  void stop() override;
  void release() override;
  [[nodiscard]] std::optional<Identity> identity() const override { return identity_; }
  [[nodiscard]] DeviceState device_state() const override { return state_; }
  [[nodiscard]] std::optional<double> reported_timeout_s() const override { return timeout_s_; }
  bool ask_settings() override;
  [[nodiscard]] std::uint64_t settings_reported() const override { return configurations_; }
  [[nodiscard]] Counters counters() const override;

 private:
  enum class Phase : std::uint8_t { sync0, sync1, sync2, open };
  void on_packet(const arcos::Packet& packet, double now);
  void on_sync(Bytes data);
  void on_status(Bytes data, double t);
  void on_encoders(Bytes data, double t);
  void on_configuration(Bytes data, double t);
  void open();
  void send_command(std::uint8_t number);
  void send_command(std::uint8_t number, int argument);

  const Profile profile_;
  arcos::PacketFinder finder_;
  std::optional<unsigned> baud_;
  Phase phase_ = Phase::sync0;
  std::optional<Identity> identity_;
  DeviceState state_;
  std::optional<double> timeout_s_;
  double pulse_due_ = 0.0;
  std::uint64_t short_packets_ = 0, other_packets_ = 0, configurations_ = 0;
};

}  // namespace odomcalib::drivers
