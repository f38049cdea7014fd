// Neato XV-11: one-way serial, counter-clockwise, 360 readings a turn, no clock of its own.
#pragma once

#include <optional>
#include <vector>

#include "drivers/lidar/common/sweep.hpp"
#include "drivers/lidar/lidar.hpp"
#include "drivers/lidar/xv11/packet.hpp"
#include "drivers/sample_clock.hpp"

namespace odomcalib::drivers {

class Xv11 final : public Lidar {
 public:
  explicit Xv11(const LidarOptions& options);

  void on_bytes(std::span<const std::uint8_t> bytes, double now) override;
  std::vector<LidarScan> take_scans() override { return sweep_.take_scans(); }
  void reset() override;
  void finish() override { sweep_.interrupt(); }
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] Counters rejected() const override { return sweep_.rejected(finder_.frames().rejected()); }

 private:
  void on_packet(const xv11::Packet& packet, double now);
  void report_packet(const xv11::Packet& packet) const;

  LidarOptions options_;
  xv11::PacketFinder finder_;
  SampleClock clock_;
  Sweep sweep_;
  std::optional<unsigned> last_index_;
};

}  // namespace odomcalib::drivers
