// Pioneer, PeopleBot and AmigoBot bases (ARCOS) on a serial line.
// Source: Pioneer 3 operations manual, open library ARIA.
//
// The firmware computes a pose of its own from TicksMM, RevCount and DriftFactor. This program uses raw
// encoder counts (packet 90h), so that those never enter a calibration; they are read and shown. Their steps
// (TicksMM 132: 0.76 %) are too coarse to hold one, and only the vendor's tool can store them: the
// calibration stays on the host.
#include <cmath>
#include <numbers>

#include "drivers/base/arcos/packet.hpp"
#include "drivers/base/arcos/settings.hpp"
#include "drivers/base/speed/speed_protocol.hpp"

namespace odomcalib::drivers {
namespace {

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

// Commands
constexpr std::uint8_t kPulse = 0, kOpen = 1, kClose = 2, kEnable = 4, kSpeed = 11, kConfiguration = 18,
                       kEncoders = 19, kTurnRate = 21, kSonar = 28, kEmergencyStop = 55;
// Packets
constexpr std::uint8_t kConfigurationPacket = 0x20, kAtRest = 0x32, kMoving = 0x33, kEncoderPacket = 0x90;
constexpr int kStream = 2;
constexpr std::size_t kFraming = 5;  // bytes around a packet's data
constexpr unsigned kMotorsEnabled = 0x0001, kEmergencyFlag = 0x0020;

/// A text ended by zero; foreign: only what prints is kept.
std::string read_text(ByteReader& reader) {
  std::string out;
  while (reader.left() > 0) {
    const std::uint8_t c = reader.u8();
    if (c == 0) return out;
    out += c >= 0x20 && c < 0x7F ? static_cast<char>(c) : '?';
  }
  reader.take(1);  // without its end: a shortage
  return out;
}

double signed16(ByteReader& reader) { return static_cast<double>(sign_extend(reader.u16(), 16)); }

MessageField field(const char* name, double number) { return {name, number, {}}; }
MessageField field(const char* name, const std::string& text) { return {name, 0.0, text}; }

}  // namespace

void Arcos::on_connected(std::optional<unsigned> baud) {
  finder_.reset();
  baud_ = baud;
  phase_ = Phase::sync0;
  timeout_s_.reset();
}

void Arcos::send_command(std::uint8_t number) { send(arcos::command(number)); }
void Arcos::send_command(std::uint8_t number, int argument) { send(arcos::command(number, argument)); }

/// SYNC0, SYNC1, SYNC2, each echoed; then the base takes commands. After a restart it wants all of it again.
void Arcos::greet(double /*now*/) {
  if (phase_ == Phase::open) return open();
  phase_ = Phase::sync0;
  send_command(kClose);  // an earlier program may have left it open: then it would not answer
  send_command(0);
}

void Arcos::open() {
  send_command(kOpen, 1);
  send_command(kSonar, 0);
  send_command(kConfiguration);
  send_command(kEncoders, kStream);
}

void Arcos::on_sync(Bytes data) {
  ByteReader reader(data);
  if (reader.u8() != static_cast<std::uint8_t>(phase_)) return;
  if (phase_ != Phase::sync2) {
    phase_ = phase_ == Phase::sync0 ? Phase::sync1 : Phase::sync2;
    return send_command(static_cast<std::uint8_t>(phase_));
  }
  identity_ = Identity{};
  for (const char* separator : {"", " ", " "}) identity_->name += separator + read_text(reader);
  phase_ = Phase::open;
  open();
}

void Arcos::on_bytes(std::span<const std::uint8_t> bytes, double now) {
  for (const arcos::Packet& packet : finder_.on_bytes(bytes)) on_packet(packet, now);
}

void Arcos::on_packet(const arcos::Packet& packet, double now) {
  // Content of a packet was true when its first byte was sent: 10 bits a byte, framing included.
  const auto bytes = static_cast<double>(packet.bytes_after + packet.data.size() + kFraming);
  const double t = now - (baud_ ? 10.0 * bytes / *baud_ : 0.0);
  const Bytes data(packet.data);
  const std::uint8_t kind = data[0];
  if (kind <= 2) return on_sync(data);
  if (kind == kAtRest || kind == kMoving) return on_status(data.subspan(1), t);
  if (kind == kEncoderPacket) return on_encoders(data.subspan(1), t);
  if (kind == kConfigurationPacket) return on_configuration(data.subspan(1), t);
  ++other_packets_;
}

void Arcos::on_encoders(Bytes data, double t) {
  ByteReader reader(data);
  const std::int64_t left = sign_extend(reader.u32(), 32);
  const std::int64_t right = sign_extend(reader.u32(), 32);
  if (!reader.ok()) {
    ++short_packets_;
    return;
  }
  count(Side::left, t, left);
  count(Side::right, t, right);
}

void Arcos::on_status(Bytes data, double t) {
  ByteReader reader(data);
  const double x = reader.u16() & 0x7FFF;
  const double y = reader.u16() & 0x7FFF;
  const double heading = signed16(reader) * 2.0 * std::numbers::pi / 4096.0;
  const double left = signed16(reader), right = signed16(reader);
  const double battery = 0.1 * reader.u8();
  const double stall = reader.u16();
  reader.take(2);  // control
  const unsigned flags = reader.u16();
  if (!reader.ok()) {
    ++short_packets_;
    return;
  }
  state_.enabled = (flags & kMotorsEnabled) != 0;
  state_.fault = (flags & kEmergencyFlag) != 0 ? "emergency stop is pressed" : "";
  report({t,
          "status",
          {field("x", x), field("y", y), field("heading_rad", heading), field("left_mm_s", left),
           field("right_mm_s", right), field("battery_V", battery), field("stall", stall),
           field("flags", flags)}});
}

void Arcos::on_configuration(Bytes data, double t) {
  ByteReader reader(data);
  const std::string type = read_text(reader), subtype = read_text(reader), serial = read_text(reader);
  reader.take(1 + 5 * 2);
  const std::string name = read_text(reader);
  reader.take(3 + 2 + 2 + 1 + 2);  // three bytes, gripper, front sonar, rear sonar, low battery
  const double rev_count = reader.u16();
  const double watchdog_ms = reader.u16();
  reader.take(1 + 2 + 2 + 2 * 2 + 2 * 2 + 10 * 2 + 4 + 1 + 1);  // stall, speeds, gains, bumpers, baud, gyro
  const double drift = signed16(reader);
  reader.take(2);
  const double ticks_per_mm = reader.u16();
  if (!reader.ok()) {
    ++short_packets_;
    return;
  }
  identity_ = Identity{0, 0, 0, 0, type + " " + subtype + " " + name + " " + serial};
  timeout_s_ = 1e-3 * watchdog_ms;
  ++configurations_;
  report({t,
          "configuration",
          {field("type", type), field("subtype", subtype), field("serial", serial), field("name", name),
           field("RevCount", rev_count), field("watchdog_ms", watchdog_ms), field("DriftFactor", drift),
           field("TicksMM", ticks_per_mm)}});
}

bool Arcos::ask_settings() {
  if (phase_ == Phase::open) send_command(kConfiguration);
  return true;
}

/// The base stops when nothing was heard for its watchdog time.
void Arcos::ask(double now) {
  if (phase_ != Phase::open || now < pulse_due_) return;
  pulse_due_ = now + arcos::kPulse_s;
  send_command(kPulse);
}

void Arcos::engage() { send_command(kEnable, 1); }
void Arcos::release() { send_command(kEnable, 0); }
void Arcos::stop() { send_command(kEmergencyStop); }

void Arcos::command(double left_rad_s, double right_rad_s) {
  const Twist twist = twist_of(profile_.robot, left_rad_s, right_rad_s);
  send_command(kSpeed, static_cast<int>(std::lround(1e3 * twist.speed)));
  send_command(kTurnRate, static_cast<int>(std::lround(twist.turn_rate * 180.0 / std::numbers::pi)));
}

Counters Arcos::counters() const {
  Counters all = finder_.counters();
  all["short_packets"] = short_packets_;
  all["other_packets"] = other_packets_;
  return all;
}

std::unique_ptr<SpeedProtocol> make_arcos(const Profile& profile) { return std::make_unique<Arcos>(profile); }

}  // namespace odomcalib::drivers
