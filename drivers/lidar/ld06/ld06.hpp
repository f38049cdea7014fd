// LDROBOT LD06, LD19 (STL-06P, STL-19P): one-way serial, clockwise, a packet of 12 points each 2.67 ms.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "drivers/device_clock.hpp"
#include "drivers/lidar/ld06/packet.hpp"
#include "drivers/lidar/lidar.hpp"

namespace odomcalib::drivers {

class Ld06 final : public Lidar {
 public:
  explicit Ld06(unsigned baud) : baud_(baud) {}

  void on_bytes(std::span<const std::uint8_t> bytes, double now) override;
  std::vector<Scan> take_scans() override;
  std::vector<std::uint8_t> take_output() override { return {}; }
  void reset() override;
  /// Those of ld06::PacketFinder, and scans, short_scans, partial_scans, lost_packets.
  [[nodiscard]] Counters counters() const override;

 private:
  struct Beam {
    double t = 0.0;          // s
    double clockwise = 0.0;  // degrees, 0..360
    ld06::Point point;
  };
  double date(const ld06::Packet& packet, double now);
  void add(const ld06::Packet& packet, double t_end);
  void finish_sweep();
  [[nodiscard]] Scan make_scan() const;
  void drop_sweep();

  unsigned baud_;
  ld06::PacketFinder finder_{4500.0};
  DeviceClock clock_{ld06::kClockModulus_ms};
  std::optional<double> last_end_;  // s, filtered end of the last packet
  double period_ = 12.0 / 4500.0;   // s between packets, measured
  bool whole_ = false;              // the sweep in progress began at 0 degrees
  double step_sum_ = 0.0;           // degrees between points, summed over the packets of the sweep
  std::size_t packets_in_sweep_ = 0;
  std::vector<Beam> sweep_;
  std::vector<Scan> scans_;
  std::uint64_t published_ = 0, short_ = 0, partial_ = 0, lost_packets_ = 0;
};

}  // namespace odomcalib::drivers
