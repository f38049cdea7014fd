// YDLIDAR, triangle protocol: serial or TCP, clockwise, no clock of its own.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/lidar/common/sweep.hpp"
#include "drivers/lidar/lidar.hpp"
#include "drivers/lidar/ydlidar/packet.hpp"
#include "drivers/lidar/ydlidar/startup.hpp"
#include "drivers/sample_clock.hpp"

namespace odomcalib::drivers {

class Ydlidar final : public Lidar {
 public:
  /// @param model of ydlidar::models(), which live for ever
  Ydlidar(const LidarOptions& options, const ydlidar::Model& model);

  void on_bytes(std::span<const std::uint8_t> bytes, double now) override;
  std::vector<LidarScan> take_scans() override { return sweep_.take_scans(); }
  std::vector<std::uint8_t> take_output() override { return startup_.take_output(); }
  [[nodiscard]] std::vector<std::uint8_t> stop_bytes() const override;
  void reset() override;
  void finish() override { sweep_.interrupt(); }
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] Counters rejected() const override { return sweep_.rejected(finder_.frames().rejected()); }
  [[nodiscard]] std::string identity() const override {
    return startup_.identity().empty() ? reported_name_ : startup_.identity();
  }
  [[nodiscard]] std::optional<Error> problem() const override;

 private:
  void on_packet(const ydlidar::Packet& packet, double now);
  double date(const ydlidar::Packet& packet, double now);
  [[nodiscard]] double step_of(const ydlidar::Packet& packet) const;
  void report_packet(const ydlidar::Packet& packet) const;
  [[nodiscard]] std::optional<Error> wrong_kind() const;

  LidarOptions options_;
  const ydlidar::Model& model_;
  ydlidar::PacketFinder finder_;
  ydlidar::Startup startup_;
  SampleClock clock_;
  Sweep sweep_;
  double usual_step_ = 0.0;    // degrees between samples
  std::string reported_name_;  // of a model that sends it unasked
};

}  // namespace odomcalib::drivers
