// LDROBOT LD06, LD19 (STL-06P, STL-19P): one-way serial, clockwise, a packet of 12 points each 2.67 ms.
#pragma once

#include <optional>
#include <vector>

#include "drivers/device_clock.hpp"
#include "drivers/lidar/common/sweep.hpp"
#include "drivers/lidar/ld06/packet.hpp"
#include "drivers/lidar/lidar.hpp"

namespace odomcalib::drivers {

class Ld06 final : public Lidar {
 public:
  /// @param points_per_s 4500, or 21600 (STL-27L)
  explicit Ld06(const LidarOptions& options, double points_per_s = 4500.0);

  void on_bytes(std::span<const std::uint8_t> bytes, double now) override;
  std::vector<LidarScan> take_scans() override { return sweep_.take_scans(); }
  void reset() override;
  void finish() override { sweep_.interrupt(); }
  /// Those of the packets and of the sweep, and lost_packets.
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] Counters rejected() const override;

 private:
  double date();
  void begin_turn();
  void add(const ld06::Packet& packet, double t_end);
  void report_packet(const ld06::Packet& packet) const;

  LidarOptions options_;
  double nominal_period_;  // s between packets
  ld06::PacketFinder finder_;
  DeviceClock clock_;
  std::optional<double> last_end_;  // s, filtered end of the last packet on the device's clock
  double host_offset_ = 0.0;        // s, of the turn in progress
  double period_;                   // s between packets, measured
  double last_angle_ = 0.0;         // degrees, clockwise
  Sweep sweep_;
  std::uint64_t lost_packets_ = 0;
};

}  // namespace odomcalib::drivers
