#include "tests/sim/wires/xv11_device.hpp"

#include <cmath>
#include <numbers>

namespace odomcalib::sim {

namespace {

std::string with_checksum(const std::string& bytes) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < 20; i += 2)
    sum = 2 * sum + static_cast<unsigned char>(bytes[i]) + 256U * static_cast<unsigned char>(bytes[i + 1]);
  return bytes + little((sum % 32'768 + sum / 32'768) % 32'768, 2);
}

}  // namespace

void Xv11Device::advance(double now) {
  const double reading_s = 1.0 / options_.turns_per_second / 360.0;
  for (; next_ + 4.0 * reading_s <= now; next_ += 4.0 * reading_s) {
    const double rpm = 60.0 * options_.turns_per_second * (1.0 + options_.told_error);
    std::string bytes = "\xFA" + little(0xA0 + packet_, 1) + little(std::uint64_t(64.0 * rpm), 2);
    for (unsigned i = 0; i < 4; ++i) {
      const double direction = (4.0 * packet_ + i) * std::numbers::pi / 180.0;
      const double range = moving_wall(direction, next_ + (i + 1) * reading_s);
      const bool invalid = packet_ == 50;
      bytes += little(invalid ? 0x8035 : static_cast<std::uint64_t>(std::lround(1000.0 * range)), 2) +
               little(300, 2);
    }
    send(with_checksum(bytes), next_ + 4.0 * reading_s);
    packet_ = (packet_ + 1) % 90;
  }
}

}  // namespace odomcalib::sim
