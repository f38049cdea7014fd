#include "tests/sim/wires/ydlidar_device.hpp"

#include <cmath>
#include <numbers>

namespace odomcalib::sim {

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Where the receiver really looks, relative to the angle the device counts, for a wall at this range: the
/// lines of sight of emitter and receiver differ by the parallax of 21.8 mm, and both meet at 155.3 mm.
double deviation_deg(double range_mm) {
  return std::atan2(21.8 * (155.3 - range_mm), 155.3 * range_mm) / kDegree;
}

}  // namespace

void YdlidarDevice::from_host(std::string_view bytes, double now) {
  if (!options_.answers) return;
  input_ += bytes;
  for (; input_.size() >= 2; input_.erase(0, 2)) {
    const auto command = static_cast<unsigned char>(input_[1]);
    if (command == 0x65) scanning_ = false;
    if (command == 0x90)
      send(text_of_hex("A55A1400000004") + std::string{6, 4, 1, 2} + std::string(16, '\x07'), now + 0.002);
    if (command == 0x92) send(text_of_hex("A55A0300000006000000"), now + 0.002);
    if (command != 0x60 || scanning_) continue;
    send(text_of_hex("A55A0500004081"), now + 0.002);
    scanning_ = true;
    next_ = now + 0.01;
    samples_.clear();
  }
}

void YdlidarDevice::advance(double now) {
  for (; scanning_ && next_ <= now; next_ += (1.0 + options_.clock_error) / options_.samples_per_s)
    measure(next_);
}

void YdlidarDevice::measure(double t) {
  const double counted = std::fmod(360.0 * options_.turns_per_second * t, 360.0);
  double range_mm = 2000.0;
  for (int i = 0; i < 5; ++i) {  // the direction depends on the range, and the range on the direction
    const double seen = counted + (options_.triangulates ? deviation_deg(range_mm) : 0.0);
    range_mm = 1000.0 * moving_wall(-seen * kDegree, t);
  }
  const bool wraps = counted < previous_;
  previous_ = counted;
  if (wraps && !samples_.empty()) send_packet(false, t);
  samples_.push_back({counted, range_mm});
  if (wraps) send_packet(true, t);
  if (samples_.size() == 40) send_packet(false, t);
}

void YdlidarDevice::send_packet(bool zero, double t) {
  const auto word = [](double degrees) {
    return static_cast<unsigned>(std::lround(degrees * 64.0)) << 1U | 1U;
  };
  const unsigned first = word(samples_.front().clockwise), last = word(samples_.back().clockwise);
  const unsigned head = (zero ? 1U | static_cast<unsigned>(10.0 * options_.turns_per_second) << 1U : 0U) |
                        static_cast<unsigned>(samples_.size()) << 8U;
  unsigned sum = 0x55AA ^ head ^ first ^ last;
  std::string body;
  for (const Sample& sample : samples_) {
    const auto mm = static_cast<unsigned>(std::lround(sample.range_mm));
    const unsigned value = options_.triangulates ? mm << 2U : mm;
    if (options_.intensity) body += '\x5A', sum ^= 0x5A;
    body += little(value, 2);
    sum ^= value;
  }
  send("\xAA\x55" + little(head, 2) + little(first, 2) + little(last, 2) + little(sum, 2) + body, t);
  samples_.clear();
}

}  // namespace odomcalib::sim
