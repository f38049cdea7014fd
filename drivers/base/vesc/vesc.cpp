// Two VESC motor controllers on one CAN bus: 29-bit identifier = command << 8 | controller, big-endian.
// Source: open firmware (bldc), comm_can.c and commands.c.
//
// The motor is released a fixed time after the last command (1 s as delivered). The tachometer counts 6 steps
// an electrical turn, so counts_per_rev = 6 x pole pairs x gear, and electrical rpm = wheel rpm x
// counts_per_rev / 6.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "drivers/base/speed/speed_protocol.hpp"
#include "drivers/base/vesc/buffer.hpp"

namespace odomcalib::drivers {
namespace {

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

using namespace vesc;

constexpr double kStepsPerElectricalTurn = 6.0;

Bytes data_of(const CanFrame& frame) {
  return Bytes(frame.data).first(std::min<std::size_t>(frame.length, 8));
}

}  // namespace

const std::vector<WireMessage>& Vesc::messages() {
  using enum WireType;
  static const std::vector<WireMessage> table = {
      {kSetCurrent, "set_current", {{"current_A", 0, i32, 1000}}},
      {kSetRpm, "set_rpm", {{"electrical_rpm", 0, i32}}},
      {kStatus1, "status", {{"electrical_rpm", 0, i32}, {"current_A", 4, i16, 10}, {"duty", 6, i16, 1000}}},
      {kStatus2, "status_2", {{"used_Ah", 0, i32, 10000}, {"charged_Ah", 4, i32, 10000}}},
      {kStatus3, "status_3", {{"used_Wh", 0, i32, 10000}, {"charged_Wh", 4, i32, 10000}}},
      {kStatus4,
       "status_4",
       {{"driver_degC", 0, i16, 10},
        {"motor_degC", 2, i16, 10},
        {"input_current_A", 4, i16, 10},
        {"position_deg", 6, i16, 50}}},
      {kStatus5, "status_5", {{"tachometer", 0, i32}, {"input_voltage_V", 4, i16, 10}}},
  };
  return table;
}

const WireMessage& Vesc::configuration() {
  using enum WireType;
  static const WireMessage layout = {
      kGetTemporaryConfiguration,
      "configuration",
      {{"motor_poles", 41, u8}, {"gear_ratio", 42, f32}, {"wheel_diameter_m", 46, f32}}};
  return layout;
}

void Vesc::on_frame(const CanFrame& frame) {
  ++frames_in_;
  const std::uint32_t command = frame.id >> 8;
  const std::uint8_t node = frame.id & 0xFF;
  const bool data = frame.extended && !frame.remote && !frame.error;
  const bool to_us = data && node == profile_.node;
  const bool of_motor = data && (node == profile_.left_node || node == profile_.right_node);
  if (to_us && (command == kFillBuffer || command == kFillBufferLong || command == kProcessBuffer))
    return on_buffer(command, frame);
  if (!of_motor || find_message(messages(), command) == nullptr) {
    ++other_frames_;
    return;
  }
  on_status(node == profile_.left_node ? Side::left : Side::right, command, frame);
}

void Vesc::on_status(Side side, std::uint32_t command, const CanFrame& frame) {
  auto message = read_message(*find_message(messages(), command), data_of(frame), Endian::big, frame.t);
  ++(message ? frames_used_ : bad_frames_);
  if (!message) return;
  if (command == kStatus5) count(side, frame.t, static_cast<std::int64_t>(message->number("tachometer")));
  message->fields.insert(message->fields.begin(), {"controller", static_cast<double>(frame.id & 0xFF), {}});
  report(std::move(*message));
}

void Vesc::on_buffer(std::uint32_t command, const CanFrame& frame) {
  ++frames_used_;
  if (command != kProcessBuffer) return buffer_.on_piece(data_of(frame), command == kFillBufferLong);
  if (const auto packet = buffer_.on_end(data_of(frame))) on_packet(*packet, frame.t);
}

void Vesc::on_packet(const std::vector<std::uint8_t>& packet, double t) {
  if (packet[0] != kGetTemporaryConfiguration) return;
  auto message = read_message(configuration(), packet, Endian::big, t);
  if (message) return report(std::move(*message));
  ++bad_packets_;
}

void Vesc::send_to(std::uint8_t node, std::uint32_t command, std::int64_t value) {
  CanFrame frame;
  frame.extended = true;
  frame.id = command << 8 | node;
  frame.length = 4;
  put_number(frame.data, 0, 4, static_cast<std::uint64_t>(value), Endian::big);
  send(frame);
}

/// Nothing needs to be asked for: status messages are switched on in the controller's own configuration. The
/// wheel diameter it holds is told for people; it belongs to the controller's own odometry.
void Vesc::greet(double /*now*/) {
  const std::array<std::uint8_t, 1> question{kGetTemporaryConfiguration};
  for (const std::uint8_t node : {profile_.left_node, profile_.right_node})
    for (const CanFrame& frame : pieces_of(question, node, profile_.node)) send(frame);
}

void Vesc::command(double left_rad_s, double right_rad_s) {
  const double electrical =
      30.0 / std::numbers::pi * profile_.ticks_per_rev / kStepsPerElectricalTurn;  // rpm per rad/s
  send_to(profile_.left_node, kSetRpm, std::lround(left_rad_s * electrical));
  send_to(profile_.right_node, kSetRpm, std::lround(right_rad_s * electrical));
}

void Vesc::release() {
  for (const std::uint8_t node : {profile_.left_node, profile_.right_node}) send_to(node, kSetCurrent, 0);
}

Counters Vesc::counters() const {
  return {{"frames_in", frames_in_},       {"frames_used", frames_used_},      {"bad_frames", bad_frames_},
          {"other_frames", other_frames_}, {"bad_pieces", buffer_.rejected()}, {"bad_packets", bad_packets_}};
}

std::unique_ptr<SpeedProtocol> make_vesc(const Profile& profile) { return std::make_unique<Vesc>(profile); }

}  // namespace odomcalib::drivers
