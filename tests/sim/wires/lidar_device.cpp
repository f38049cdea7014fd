#include "tests/sim/wires/lidar_device.hpp"

#include <algorithm>
#include <cmath>

namespace odomcalib::sim {

double moving_wall(double direction, double t) {
  return 2.0 + 0.5 * std::cos(direction) + 0.2 * std::sin(direction) + 1.0 * t;
}

void LidarDevice::send(const std::string& bytes, double ready) {
  const double transmission = bytes_per_s_ > 0.0 ? static_cast<double>(bytes.size()) / bytes_per_s_ : 0.0;
  line_free_ = std::max(ready, line_free_) + transmission;
  waiting_.push_back({line_free_, bytes});
}

std::string LidarDevice::take(double now) {
  std::string out;
  while (!waiting_.empty() && waiting_.front().due <= now) {
    out += waiting_.front().bytes;
    waiting_.pop_front();
  }
  if (garbled_)
    for (char& c : out) c = static_cast<char>((c * 37 + 11) ^ (c >> 3));
  return out;
}

std::string little(std::uint64_t value, int bytes) {
  std::string out;
  for (int i = 0; i < bytes; ++i) out += static_cast<char>(value >> static_cast<unsigned>(8 * i));
  return out;
}

std::string big(std::uint64_t value, int bytes) {
  std::string out = little(value, bytes);
  std::reverse(out.begin(), out.end());
  return out;
}

std::string text_of_hex(std::string_view digits) {
  std::string out;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    out += static_cast<char>(std::stoi(std::string(digits.substr(i, 2)), nullptr, 16));
  return out;
}

}  // namespace odomcalib::sim
