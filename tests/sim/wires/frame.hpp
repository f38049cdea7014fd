// A CAN frame on the simulated bus.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>

namespace odomcalib::sim {

struct Frame {
  std::uint32_t id = 0;
  bool extended = false;
  bool remote = false;
  std::uint8_t length = 0;
  std::array<std::uint8_t, 8> data{};

  friend bool operator==(const Frame&, const Frame&) = default;
};

/// Data frame with an 11-bit identifier; bytes beyond the eighth are dropped.
inline Frame make_frame(std::uint32_t id, std::initializer_list<int> bytes) {
  Frame frame;
  frame.id = id;
  for (const int byte : bytes)
    if (frame.length < 8) frame.data[frame.length++] = static_cast<std::uint8_t>(byte);
  return frame;
}

/// Little-endian, as everything in CANopen.
inline std::uint32_t get_u32(const std::uint8_t* bytes, unsigned count) {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < count; ++i) value |= static_cast<std::uint32_t>(bytes[i]) << (8 * i);
  return value;
}

inline void put_u32(std::uint8_t* bytes, unsigned count, std::uint32_t value) {
  for (unsigned i = 0; i < count; ++i) bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
}

}  // namespace odomcalib::sim
