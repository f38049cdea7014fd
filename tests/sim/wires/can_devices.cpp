#include "tests/sim/wires/can_devices.hpp"

#include <bit>
#include <cstring>

#include "tests/sim/world/disturbance.hpp"

namespace odomcalib::sim {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

Frame frame_of(std::uint32_t id, bool extended, std::uint8_t length) {
  Frame frame;
  frame.id = id;
  frame.extended = extended;
  frame.length = length;
  return frame;
}

/// Most significant byte first.
void put_big(Frame& frame, unsigned at, unsigned bytes, std::int64_t value) {
  for (unsigned i = 0; i < bytes; ++i)
    frame.data[at + i] =
        static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8U * (bytes - 1U - i)));
}

std::int32_t big_i32(const Frame& frame, unsigned at) {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < 4; ++i) value = value << 8U | frame.data[at + i];
  return static_cast<std::int32_t>(value);
}

std::int16_t big_i16(const Frame& frame, unsigned at) {
  return static_cast<std::int16_t>(frame.data[at] << 8 | frame.data[at + 1U]);
}

}  // namespace

std::vector<Frame> CanDevice::advance(double now) {
  wheels_.advance(last_ > 0.0 ? now - last_ : 0.0);
  last_ = now;
  watch(now);
  std::vector<Frame> out;
  ++ticks_;
  talk(now, out);
  return silent ? std::vector<Frame>{} : out;
}

void AgilexChassis::receive(const Frame& frame, double now) {
  if (frame.id == 0x421 && frame.length >= 1) can_control_ = frame.data[0] == 1;
  if (!can_control_) wheels_.rate = {};
  if (frame.id != 0x111 || frame.length < 4 || !can_control_ || emergency_stop) return;
  const double speed = 1e-3 * big_i16(frame, 0), turn = 1e-3 * big_i16(frame, 2);
  wheels_.rate = {(speed - 0.172 * turn) / 0.0635, (speed + 0.172 * turn) / 0.0635};
  commanded_at_ = now;
}

void AgilexChassis::watch(double now) {
  if (now - commanded_at_ > 0.5 || emergency_stop) wheels_.rate = {};
}

void AgilexChassis::talk(double /*now*/, std::vector<Frame>& out) {
  slot_ = (slot_ + 1) % 20;  // each message every 20 ms
  if (slot_ == 5) {
    Frame state = make_frame(0x211, {emergency_stop ? 1 : 0, can_control_ ? 1 : 0, 1, 3, 0, 0, 0, 0});
    out.push_back(state);
  }
  if (slot_ != 9) return;
  for (const std::size_t side : {kRight, kLeft}) {  // 251h is the right motor
    Frame motor = frame_of(side == kRight ? 0x251 : 0x252, false, 8);
    put_big(motor, 0, 2, std::lround(wheels_.rate[side] * 60.0 / kTwoPi));
    put_big(motor, 4, 4, wheels_.count(side, 4096.0) & 0xFFFFFF);
    out.push_back(motor);
  }
}

void VescPair::receive(const Frame& frame, double now) {
  const unsigned id = frame.id & 0xFFU, command = frame.id >> 8U;
  if (!frame.extended || id < 1 || id > 2) return;
  const std::size_t side = id - 1;
  if (command == 3 && frame.length == 4) {
    wheels_.rate[side] = big_i32(frame, 0) / 23.0 * kTwoPi / 60.0;
    commanded_at_[side] = now;
  }
  if (command == 1) wheels_.rate[side] = 0.0;
  // A buffer that is closed asks for something: the answer is the 50 bytes of the temporary configuration.
  if (command != 7 || frame.length != 6) return;
  ++asked_;
  std::array<std::uint8_t, 50> answer{};
  answer[0] = 91;
  answer[41] = 46;
  const auto put_float = [&](std::size_t at, float value) {
    const auto raw = std::bit_cast<std::uint32_t>(value);
    for (std::size_t i = 0; i < 4; ++i) answer[at + i] = static_cast<std::uint8_t>(raw >> (24U - 8U * i));
  };
  put_float(42, 1.0F);
  put_float(46, 0.168F);
  unsigned crc = 0;
  for (const std::uint8_t byte : answer) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      const bool one = ((byte >> (7U - bit)) & 1U) != ((crc >> 15U) & 1U);
      crc = (crc << 1U) & 0xFFFFU;
      if (one) crc ^= 0x1021U;
    }
  }
  const std::uint32_t to = frame.data[0];
  for (std::size_t at = 0; at < answer.size(); at += 7) {
    const std::size_t n = std::min<std::size_t>(7, answer.size() - at);
    Frame piece = frame_of(5U << 8U | to, true, static_cast<std::uint8_t>(n + 1));
    piece.data[0] = static_cast<std::uint8_t>(at);
    std::memcpy(&piece.data[1], &answer[at], n);
    answers_.push_back(piece);
  }
  Frame end = frame_of(7U << 8U | to, true, 6);
  end.data = {static_cast<std::uint8_t>(id),         1, 0, 50, static_cast<std::uint8_t>(crc >> 8U),
              static_cast<std::uint8_t>(crc & 0xFFU)};
  answers_.push_back(end);
}

void VescPair::watch(double now) {
  for (const std::size_t side : {kLeft, kRight})
    if (now - commanded_at_[side] > 1.0) wheels_.rate[side] = 0.0;
}

void VescPair::talk(double /*now*/, std::vector<Frame>& out) {
  out.swap(answers_);
  slot_ = (slot_ + 1) % 20;
  for (const std::size_t side : {kLeft, kRight}) {
    if (slot_ != 4 + 7 * side) continue;  // not at the same time
    Frame status = frame_of(27U << 8U | static_cast<std::uint32_t>(side + 1), true, 8);
    put_big(status, 0, 4, wheels_.count(side, 138.0));
    put_big(status, 4, 2, 361);
    out.push_back(status);
    Frame erpm = frame_of(9U << 8U | static_cast<std::uint32_t>(side + 1), true, 8);
    put_big(erpm, 0, 4, std::lround(wheels_.rate[side] * 60.0 / kTwoPi * 23.0));
    out.push_back(erpm);
  }
}

void OdrivePair::receive(const Frame& frame, double now) {
  const unsigned node = frame.id >> 5U, command = frame.id & 0x1FU;
  if (frame.extended || node < 1 || node > 2) return;
  const std::size_t side = node - 1;
  if (command == 0x0A && frame.remote) {
    Frame count = frame_of(frame.id, false, 8);
    put_u32(count.data.data(), 4, static_cast<std::uint32_t>(wheels_.count(side, 8192.0)));
    return answers_.push_back(count);
  }
  if (command == 0x07 && frame.length >= 4 && error_[side] == 0) {
    state_[side] = frame.data[0];
    fed_at_[side] = now;
  }
  if (command != 0x0D || frame.length < 4) return;
  fed_at_[side] = now;
  const auto turns = static_cast<double>(std::bit_cast<float>(get_u32(frame.data.data(), 4)));
  wheels_.rate[side] = state_[side] == 8 ? turns * kTwoPi : 0.0;
}

void OdrivePair::watch(double now) {
  for (const std::size_t side : {kLeft, kRight}) {
    if (state_[side] == 8 && now - fed_at_[side] > 0.1) {
      error_[side] = 0x800;  // watchdog timer expired
      state_[side] = 1;
    }
    if (state_[side] != 8) wheels_.rate[side] = 0.0;
  }
}

void OdrivePair::talk(double /*now*/, std::vector<Frame>& out) {
  out.swap(answers_);
  slot_ = (slot_ + 1) % 100;
  if (slot_ != 50) return;
  for (const std::size_t side : {kLeft, kRight}) {
    Frame heartbeat = frame_of(static_cast<std::uint32_t>(side + 1) << 5U | 1U, false, 8);
    put_u32(heartbeat.data.data(), 4, error_[side]);
    heartbeat.data[4] = static_cast<std::uint8_t>(state_[side]);
    out.push_back(heartbeat);
  }
}

}  // namespace odomcalib::sim
