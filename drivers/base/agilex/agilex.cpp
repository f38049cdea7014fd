// AgileX chassis (Scout, Tracer, Bunker, Hunter), protocol V2: CAN, 11 bit, big-endian, no checksum.
// Source: AgileX user manuals, open driver ugv_sdk.
#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/base/speed/speed_protocol.hpp"

namespace odomcalib::drivers {
namespace {

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

constexpr std::uint32_t kMotion = 0x111, kState = 0x211, kFirstMotor = 0x251, kLastMotor = 0x254,
                        kOdometer = 0x311, kControl = 0x421, kVersion = 0x4A1;
constexpr double kEmergencyStop = 1.0, kFault = 2.0;  // 211h, first byte
constexpr double kCanControl = 1.0;                   // 211h, second byte

std::vector<WireMessage> make_table() {
  using enum WireType;
  std::vector<WireMessage> table = {
      {kMotion, "motion_command", {{"speed_m_s", 0, i16, 1000}, {"yaw_rate_rad_s", 2, i16, 1000}}},
      {kState,
       "state",
       {{"state", 0, u8},
        {"mode", 1, u8},
        {"battery_V", 2, u16, 10},
        {"error_bits", 4, u16},
        {"counter", 7, u8}}},
      {0x221,
       "motion",
       {{"speed_m_s", 0, i16, 1000},
        {"yaw_rate_rad_s", 2, i16, 1000},
        {"lateral_m_s", 4, i16, 1000},
        {"steering_rad", 6, i16, 1000}}},
      {kOdometer, "odometer", {{"left_m", 0, i32, 1000}, {"right_m", 4, i32, 1000}}},
      {kControl, "control_mode", {{"mode", 0, u8}}},
  };
  for (std::uint32_t motor = 0; motor < 4; ++motor) {
    table.push_back(
        {kFirstMotor + motor, "motor", {{"rpm", 0, i16}, {"current_A", 2, i16, 10}, {"pulses", 4, u32}}});
    table.push_back(
        {0x261 + motor,
         "motor_driver",
         {{"voltage_V", 0, u16, 10}, {"driver_degC", 2, i16}, {"motor_degC", 4, i8}, {"state", 5, u8}}});
  }
  return table;
}

bool is_motor(std::uint32_t id) { return id >= kFirstMotor && id <= kLastMotor; }

}  // namespace

const std::vector<WireMessage>& Agilex::messages() {
  static const std::vector<WireMessage> table = make_table();
  return table;
}

void Agilex::on_frame(const CanFrame& frame) {
  ++frames_in_;
  const WireMessage* layout =
      frame.extended || frame.remote || frame.error ? nullptr : find_message(messages(), frame.id);
  if (layout == nullptr) {
    ++other_frames_;
    return;
  }
  auto message = read_message(*layout, Bytes(frame.data).first(std::min<std::size_t>(frame.length, 8)),
                              Endian::big, frame.t);
  if (!message) {
    ++bad_frames_;
    return;
  }
  ++frames_used_;
  if (frame.id == kState) on_state(*message);
  if (frame.id == kOdometer) on_odometer(*message);
  if (is_motor(frame.id)) on_motor(frame.id - kFirstMotor + 1, *message);
  const bool numbered = is_motor(frame.id) || message->name == "motor_driver";
  if (numbered)
    message->fields.insert(message->fields.begin(), {"motor", static_cast<double>(frame.id & 0xF), {}});
  report(std::move(*message));
}

void Agilex::on_state(const DeviceMessage& message) {
  state_.enabled = message.number("mode") == kCanControl;
  state_.fault.clear();
  if (message.number("state") == kEmergencyStop) state_.fault = "emergency stop button is pressed";
  if (message.number("state") == kFault)
    state_.fault =
        "chassis reports a fault, error bits " + std::to_string(std::lround(message.number("error_bits")));
}

/// The count is a two's complement number of the width that the profile states: some firmware does not extend
/// the sign of 24 bits. Its low bits are the same either way.
void Agilex::on_motor(std::uint32_t motor, DeviceMessage& message) {
  MessageField& pulses = message.fields.back();
  const std::int64_t raw = sign_extend(static_cast<std::uint64_t>(pulses.number), profile_.count_bits);
  pulses.number = static_cast<double>(raw);
  if (profile_.count_source != "pulses") return;
  if (motor == profile_.left_node) count(Side::left, message.t, raw);
  if (motor == profile_.right_node) count(Side::right, message.t, raw);
}

void Agilex::on_odometer(const DeviceMessage& message) {
  if (profile_.count_source != "odometer") return;
  count(Side::left, message.t, std::llround(1e3 * message.number("left_m")));
  count(Side::right, message.t, std::llround(1e3 * message.number("right_m")));
}

void Agilex::send_bytes(std::uint32_t id, std::span<const std::uint8_t> data) {
  CanFrame frame;
  frame.id = id;
  frame.length = static_cast<std::uint8_t>(data.size());
  std::copy(data.begin(), data.end(), frame.data.begin());
  send(frame);
}

void Agilex::greet(double /*now*/) { send_bytes(kVersion, std::array<std::uint8_t, 1>{1}); }

void Agilex::engage() { send_bytes(kControl, std::array<std::uint8_t, 1>{1}); }

void Agilex::release() { send_bytes(kControl, std::array<std::uint8_t, 1>{0}); }

void Agilex::command(double left_rad_s, double right_rad_s) {
  const Twist twist = twist_of(profile_.robot, left_rad_s, right_rad_s);
  std::array<std::uint8_t, 8> data{};
  put_number(data, 0, 2, static_cast<std::uint64_t>(std::lround(1e3 * twist.speed)), Endian::big);
  put_number(data, 2, 2, static_cast<std::uint64_t>(std::lround(1e3 * twist.turn_rate)), Endian::big);
  send_bytes(kMotion, data);
}

Counters Agilex::counters() const {
  return {{"frames_in", frames_in_},
          {"frames_used", frames_used_},
          {"bad_frames", bad_frames_},
          {"other_frames", other_frames_}};
}

std::unique_ptr<SpeedProtocol> make_agilex(const Profile& profile) {
  return std::make_unique<Agilex>(profile);
}

}  // namespace odomcalib::drivers
