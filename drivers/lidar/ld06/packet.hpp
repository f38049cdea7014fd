// The 47-byte packet of LDROBOT's LD06 family, and how to find it in a stream of bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "drivers/lidar/common/frame_buffer.hpp"

namespace odomcalib::drivers::ld06 {

inline constexpr std::size_t kPacketBytes = 47;
inline constexpr std::size_t kPoints = 12;
inline constexpr unsigned kClockModulus_ms = 30'000;

struct Point {
  std::uint16_t range_mm = 0;  ///< 0: no echo
  std::uint8_t intensity = 0;
};

struct Packet {
  unsigned speed_deg_s = 0;
  unsigned start_cdeg = 0;  ///< 0.01 degree, clockwise from the front arrow, 0..35999
  unsigned span_cdeg = 0;   ///< from the first to the last point, 0..35999
  unsigned stamp_ms = 0;    ///< device clock at the end of the packet's measurement
  std::array<Point, kPoints> points{};
  std::size_t bytes_after = 0;  ///< bytes of the same read that came after it, to date it
};

/// CRC-8, polynomial 4Dh, initial value 0, not reflected.
std::uint8_t crc8(Bytes bytes);

class PacketFinder {
 public:
  /// @param points_per_s of the model: 4500 (LD06, LD19), 21600 (STL-27L); the span must fit speed and this
  /// rate
  explicit PacketFinder(double points_per_s) : points_per_s_(points_per_s) {}

  std::vector<Packet> on_bytes(Bytes bytes);
  void reset() { frames_.reset(); }
  [[nodiscard]] const FrameBuffer& frames() const { return frames_; }

 private:
  Verdict look(Bytes rest, std::vector<Packet>& out) const;
  [[nodiscard]] const char* fault_of(const Packet& packet, unsigned end_cdeg) const;
  [[nodiscard]] bool span_fits(const Packet& packet) const;

  double points_per_s_;
  FrameBuffer frames_{"bad_checksum", "bad_field", "bad_span", "motor_stopped"};
};

}  // namespace odomcalib::drivers::ld06
