// Beams as the bytes of an LDROBOT LD06: packets of 12 points, 47 bytes, sent as soon as they are measured.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "tests/sim/world/lidar_head.hpp"

namespace odomcalib::sim {

/// CRC-8 with polynomial 4Dh, initial value 0, not reflected.
std::uint8_t ld06_checksum(std::span<const std::uint8_t> bytes);

struct Ld06Packet {
  double speed = 0.0;        ///< deg/s
  double start_angle = 0.0;  ///< deg
  double end_angle = 0.0;    ///< deg
  double time = 0.0;         ///< s, device clock
  std::vector<Beam> points;  ///< twelve
};

std::vector<std::uint8_t> encode_ld06(const Ld06Packet& packet);

/// Switches for tests.
struct LidarFaults {
  bool cut = false;           ///< the cable: nothing arrives
  bool frozen = false;        ///< the same turn over and over
  bool blind = false;         ///< no beam has an echo
  double extra_delay = 0.0;   ///< s
  double share_lost = 0.0;    ///< of the packets, chosen regularly
  bool mirrored = false;      ///< mounted upside down: left is right (a turn late)
  bool half_packets = false;  ///< the second half of every packet is missing
};

class Ld06Stream {
 public:
  struct Chunk {
    double due = 0.0;  ///< s, when the last byte has been transmitted
    std::vector<std::uint8_t> bytes;
  };

  Ld06Stream(const LidarOptions& options, double clock_offset, double clock_rate_error);
  void add(const Beam& beam);
  /// s that packets take longer from now on.
  void set_lateness(double seconds) { lateness_ = seconds; }
  /// Power cycle: the first 0.2 s say speed 0 and wrong angles, and the device clock restarts.
  void restart(double now);
  /// Bytes that have been transmitted up to now.
  std::vector<std::uint8_t> take(double now);
  LidarFaults faults;

 private:
  void finish();
  [[nodiscard]] double device_time(double now) const;
  Beam altered(Beam beam);

  LidarOptions options_;
  double clock_offset_, clock_rate_;
  double started_ = -10.0, lateness_ = 0.0, last_due_ = 0.0;
  std::uint64_t packets_ = 0;
  std::vector<Beam> gathered_;
  std::vector<double> frozen_ranges_;
  std::deque<Chunk> waiting_;
};

}  // namespace odomcalib::sim
