#include "tests/sim/wires/rplidar_device.hpp"

#include <cmath>
#include <numbers>

namespace odomcalib::sim {

namespace {

std::string rplidar_frame(const std::string& body) {
  unsigned sum = 0;
  for (const char c : body) sum ^= static_cast<unsigned char>(c);
  return std::string{static_cast<char>(0xA0 | (sum & 0xF)), static_cast<char>(0x50 | (sum >> 4))} + body;
}

unsigned quarters(double range_mm) { return static_cast<unsigned>(std::lround(4.0 * range_mm)); }

}  // namespace

void RplidarDevice::answer(int type, const std::string& payload, double now) {
  send("\xA5\x5A" + little(payload.size(), 4) + static_cast<char>(type) + payload, now + 0.002);
}

void RplidarDevice::start(Data data, double now) {
  const char* descriptor = data == Data::standard  ? "A55A0500004081"
                           : data == Data::express ? "A55A5400004082"
                                                   : "A55A5400004085";
  send(text_of_hex(descriptor), now + 0.002);
  data_ = data;
  scanning_ = first_ = true;
  next_ = now + 0.01;
  samples_.clear();
}

void RplidarDevice::on_request(int command, std::string_view payload, double now) {
  const auto code = [&](std::size_t i) {
    return i < payload.size() ? static_cast<unsigned char>(payload[i]) : 0;
  };
  const int type = options_.data == Data::standard ? 0x81 : options_.data == Data::express ? 0x82 : 0x85;
  if (command == 0x25) scanning_ = false;
  if (command == 0x40) options_.health = 0, ++resets;
  if (command == 0x50)
    answer(0x04,
           std::string{0x18, static_cast<char>(options_.configurable ? 29 : 20), 1, 7} + std::string(16, 'S'),
           now);
  if (command == 0x52)
    answer(0x06, little(static_cast<unsigned>(options_.health), 1) + little(0x8002, 2), now);
  if (command == 0x59)
    answer(0x15, little(500, 2) + little(static_cast<unsigned>(options_.sample_s * 1e6), 2), now);
  if (command == 0x20) start(Data::standard, now);
  if (command == 0x82) start(options_.data, now);
  if (command != 0x84 || !options_.configurable) return;
  const std::string key = little(static_cast<unsigned>(code(0)), 4);
  if (code(0) == 0x7C) answer(0x20, key + little(2, 2), now);
  if (code(0) == 0x75) answer(0x20, key + little(static_cast<unsigned>(type), 1), now);
  if (code(0) == 0x71) answer(0x20, key + little(static_cast<unsigned>(options_.sample_s * 256e6), 4), now);
  if (code(0) == 0x74) answer(0x20, key + little(std::uint64_t{12} * 256, 4), now);
}

void RplidarDevice::from_host(std::string_view bytes, double now) {
  input_ += bytes;
  while (input_.size() >= 2) {
    const auto command = static_cast<unsigned char>(input_[1]);
    const bool long_form = (command & 0x80) != 0;
    if (long_form && input_.size() < 3) return;
    const std::size_t payload = long_form ? static_cast<unsigned char>(input_[2]) : 0;
    const std::size_t size = long_form ? 4 + payload : 2;
    if (input_.size() < size) return;
    on_request(command, std::string_view(input_).substr(long_form ? 3 : 2, payload), now);
    input_.erase(0, size);
  }
}

void RplidarDevice::advance(double now) {
  while (scanning_ && next_ <= now) {
    measure(next_);
    next_ += (data_ == Data::standard && options_.data != Data::standard ? 500e-6 : options_.sample_s) *
             (1.0 + options_.clock_error);
  }
}

/// The range is taken one and a half samples before the sample counts as done, as the device's filter does.
void RplidarDevice::measure(double t) {
  const double t_beam = t - 1.5 * options_.sample_s;
  const double clockwise = std::fmod(360.0 * options_.turns_per_second * t_beam, 360.0);
  const double range = moving_wall(-clockwise * std::numbers::pi / 180.0, t_beam);
  samples_.push_back({clockwise, 1000.0 * range});
  pack(t);
}

void RplidarDevice::pack(double t) {
  if (data_ == Data::standard) {
    const Sample& s = samples_.back();
    const unsigned start = s.clockwise < previous_angle_ ? 1 : 2;
    previous_angle_ = s.clockwise;
    send(little(15U << 2U | start, 1) + little(static_cast<unsigned>(s.clockwise * 64.0) << 1U | 1U, 2) +
             little(quarters(s.range_mm), 2),
         t);
    samples_.clear();
  } else if (samples_.size() == (data_ == Data::express ? 32U : 40U)) {
    const unsigned start = static_cast<unsigned>(samples_.front().clockwise * 64.0) | (first_ ? 0x8000U : 0U);
    first_ = false;
    send(rplidar_frame(little(start, 2) + (data_ == Data::express ? express_capsule() : dense_capsule())), t);
    samples_.clear();
  }
}

std::string RplidarDevice::express_capsule() const {
  std::string out;
  for (std::size_t i = 0; i < 32; i += 2)
    out += little(static_cast<unsigned>(std::lround(samples_[i].range_mm)) << 2U, 2) +
           little(static_cast<unsigned>(std::lround(samples_[i + 1].range_mm)) << 2U, 2) + little(0, 1);
  return out;
}

std::string RplidarDevice::dense_capsule() const {
  std::string out;
  for (const Sample& s : samples_) out += little(static_cast<unsigned>(std::lround(s.range_mm)), 2);
  return out;
}

}  // namespace odomcalib::sim
