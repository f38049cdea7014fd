// Requests to an RPLIDAR, and their answers' type bytes.
// Source: SLAMTEC, "RPLIDAR Interface Protocol and Application Notes".
#pragma once

#include <cstdint>
#include <vector>

#include "drivers/bytes.hpp"

namespace odomcalib::drivers::rplidar {

enum class Command : std::uint8_t {
  stop = 0x25,
  reset = 0x40,
  scan = 0x20,
  info = 0x50,
  health = 0x52,
  sample_time = 0x59,
  express_scan = 0x82,
  configuration = 0x84,
  motor_speed = 0xA8,
  motor_pwm = 0xF0,
  motor_board = 0xFF
};

enum class AnswerType : std::uint8_t {
  info = 0x04,
  health = 0x06,
  sample_time = 0x15,
  configuration = 0x20,
  motor_board = 0xFF
};

/// Keys of Command::configuration.
enum class Setting : std::uint32_t {
  sample_time = 0x71,
  range_max = 0x74,
  packet_type = 0x75,
  typical_mode = 0x7C,
  name = 0x7F
};

/// A5, command and, when there is a payload, its length, itself and the XOR of everything.
inline std::vector<std::uint8_t> encode(Command command, Bytes payload = {}) {
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
