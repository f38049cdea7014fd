// The 22-byte packet of Neato's XV-11 lidar: four readings, one degree apart.
// Source: xv11hacking.wikispaces.com, "LIDAR sensor", firmware 2.4 and later.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "drivers/lidar/common/frame_buffer.hpp"

namespace odomcalib::drivers::xv11 {

inline constexpr std::size_t kPacketBytes = 22;
inline constexpr std::size_t kReadings = 4;
inline constexpr unsigned kPackets = 90;  // a turn

struct Reading {
  unsigned range_mm = 0;  ///< 0: no reading; the low byte then was an error code
  unsigned error = 0;     ///< code of an invalid reading
  bool weak = false;      ///< strength below what the distance lets expect
  std::uint16_t strength = 0;
};

struct Packet {
  unsigned index = 0;  ///< 0..89, four degrees each
  double rpm = 0.0;
  std::array<Reading, kReadings> readings{};
  std::size_t bytes_after = 0;  ///< of the same read, behind this packet
};

class PacketFinder {
 public:
  std::vector<Packet> on_bytes(Bytes bytes);
  void reset() { frames_.reset(); }
  [[nodiscard]] FrameBuffer& frames() { return frames_; }
  [[nodiscard]] const FrameBuffer& frames() const { return frames_; }

 private:
  FrameBuffer frames_{"bad_checksum", "motor_stopped", "bad_speed", "repeated_packets", "lost_packets"};
};

/// Over the first 20 bytes.
std::uint16_t checksum(Bytes bytes);

}  // namespace odomcalib::drivers::xv11
