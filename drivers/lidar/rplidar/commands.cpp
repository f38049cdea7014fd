#include "drivers/lidar/rplidar/commands.hpp"

namespace odomcalib::drivers::rplidar {

std::vector<std::uint8_t> encode(Command command, Bytes payload) {
  std::vector<std::uint8_t> out = {0xA5, static_cast<std::uint8_t>(command)};
  if (payload.empty()) return out;
  out.push_back(static_cast<std::uint8_t>(payload.size()));
  out.insert(out.end(), payload.begin(), payload.end());
  std::uint8_t sum = 0;
  for (const std::uint8_t byte : out) sum ^= byte;
  out.push_back(sum);
  return out;
}

}  // namespace odomcalib::drivers::rplidar
