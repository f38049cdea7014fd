// ODrive CANSimple, two axes: CAN, 11-bit identifier = node << 5 | command, little-endian.
// Source: ODrive CAN protocol documentation.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "drivers/base/odrive/settings.hpp"
#include "drivers/base/speed/speed_protocol.hpp"

namespace odomcalib::drivers {
namespace {

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

using namespace odrive;

constexpr std::uint32_t kHeartbeat = 0x01, kSetState = 0x07, kEstimates = 0x09, kCount = 0x0A, kMode = 0x0B,
                        kSpeed = 0x0D;
constexpr double kIdle = 1.0, kClosedLoop = 8.0;

}  // namespace

const std::vector<WireMessage>& Odrive::messages() {
  using enum WireType;
  static const std::vector<WireMessage> table = {
      {kHeartbeat, "heartbeat", {{"error", 0, u32}, {"state", 4, u8}}},
      {0x03, "motor_error", {{"error", 0, u32}}},
      {0x04, "encoder_error", {{"error", 0, u32}}},
      {kSetState, "set_state", {{"state", 0, u32}}},
      {kEstimates, "estimates", {{"position_turns", 0, f32}, {"speed_turns_s", 4, f32}}},
      {kCount, "encoder_count", {{"count", 0, i32}, {"count_in_turn", 4, i32}}},
      {kMode, "controller_mode", {{"control", 0, u32}, {"input", 4, u32}}},
      {kSpeed, "input_speed", {{"speed_turns_s", 0, f32}, {"torque", 4, f32}}},
      {0x17, "bus", {{"voltage_V", 0, f32}, {"current_A", 4, f32}}},
  };
  return table;
}

void Odrive::on_frame(const CanFrame& frame) {
  ++frames_in_;
  const std::uint32_t node = frame.id >> 5;
  const bool ours = node == profile_.left_node || node == profile_.right_node;
  const bool data = !frame.extended && !frame.remote && !frame.error;
  const WireMessage* layout = data && ours ? find_message(messages(), frame.id & 0x1F) : nullptr;
  if (layout == nullptr) {
    ++other_frames_;
    return;
  }
  auto message = read_message(*layout, Bytes(frame.data).first(std::min<std::size_t>(frame.length, 8)),
                              Endian::little, frame.t);
  ++(message ? frames_used_ : bad_frames_);
  if (!message) return;
  on_message(node == profile_.left_node ? Side::left : Side::right, *message);
  message->fields.insert(message->fields.begin(), {"node", static_cast<double>(node), {}});
  report(std::move(*message));
}

void Odrive::on_message(Side side, const DeviceMessage& message) {
  Axis& axis = axes_[static_cast<std::size_t>(side)];
  if (message.name == "heartbeat") {
    axis.error = message.number("error");
    axis.state = message.number("state");
  }
  if (message.name == "encoder_count" && profile_.count_source == "count")
    count(side, message.t, static_cast<std::int64_t>(message.number("count")));
  if (message.name != "estimates" || profile_.count_source != "estimates") return;
  const double turns = message.number("position_turns");
  if (std::abs(turns) > kFineTurns) ++coarse_;
  if (std::abs(turns) > kMostTurns) return;
  count(side, message.t, std::llround(turns * profile_.ticks_per_rev / profile_.motor_turns_per_rev));
}

void Odrive::send_to(std::uint8_t node, std::uint32_t command, std::span<const std::uint8_t> data,
                     bool remote) {
  CanFrame frame;
  frame.id = static_cast<std::uint32_t>(node) << 5 | command;
  frame.remote = remote;
  frame.length = static_cast<std::uint8_t>(remote ? 8 : data.size());
  std::copy(data.begin(), data.end(), frame.data.begin());
  send(frame);
}

void Odrive::to_both(std::uint32_t command, std::span<const std::uint8_t> data) {
  for (const std::uint8_t node : {profile_.left_node, profile_.right_node}) send_to(node, command, data);
}

void Odrive::ask(double now) {
  if (profile_.count_source != "count" || now < ask_due_) return;
  ask_due_ = now + kAsk_s;
  for (const std::uint8_t node : {profile_.left_node, profile_.right_node}) send_to(node, kCount, {}, true);
}

void Odrive::engage() {
  std::array<std::uint8_t, 8> mode{};
  put_number(mode, 0, 4, 2, Endian::little);  // velocity control
  put_number(mode, 4, 4, 1, Endian::little);  // input passed through: the ramp is ours
  to_both(kMode, mode);
  std::array<std::uint8_t, 4> state{static_cast<std::uint8_t>(kClosedLoop)};
  command(0.0, 0.0);
  to_both(kSetState, state);
}

void Odrive::release() {
  const std::array<std::uint8_t, 4> state{static_cast<std::uint8_t>(kIdle)};
  to_both(kSetState, state);
}

void Odrive::command(double left_rad_s, double right_rad_s) {
  const double turns = profile_.motor_turns_per_rev / (2.0 * std::numbers::pi);
  const auto payload = [&](double rad_s) {
    std::array<std::uint8_t, 8> data{};
    put_number(data, 0, 4, std::bit_cast<std::uint32_t>(static_cast<float>(rad_s * turns)), Endian::little);
    return data;
  };
  send_to(profile_.left_node, kSpeed, payload(left_rad_s));
  send_to(profile_.right_node, kSpeed, payload(right_rad_s));
}

DeviceState Odrive::device_state() const {
  DeviceState state;
  state.enabled = axes_[0].state == kClosedLoop && axes_[1].state == kClosedLoop;
  for (const Axis& axis : axes_)
    if (axis.error != 0.0) state.fault = "axis error " + std::to_string(std::llround(axis.error));
  return state;
}

Counters Odrive::counters() const {
  return {{"frames_in", frames_in_},
          {"frames_used", frames_used_},
          {"bad_frames", bad_frames_},
          {"other_frames", other_frames_},
          {"coarse_positions", coarse_}};
}

std::unique_ptr<SpeedProtocol> make_odrive(const Profile& profile) {
  return std::make_unique<Odrive>(profile);
}

}  // namespace odomcalib::drivers
