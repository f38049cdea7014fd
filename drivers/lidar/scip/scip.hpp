// Hokuyo sensors with SCIP 2.0 (URG, UTM, UST): serial, USB or TCP, counter-clockwise, millisecond clock.
#pragma once

#include <optional>
#include <vector>

#include "drivers/device_clock.hpp"
#include "drivers/lidar/common/stamp_line.hpp"
#include "drivers/lidar/lidar.hpp"
#include "drivers/lidar/scip/startup.hpp"

namespace odomcalib::drivers {

class Scip final : public Lidar {
 public:
  /// @param known geometry to begin with; what the sensor tells goes before
  explicit Scip(const LidarOptions& options, bool intensities = false,
                std::optional<scip::Parameters> known = std::nullopt);

  void on_bytes(std::span<const std::uint8_t> bytes, double now) override;
  std::vector<LidarScan> take_scans() override;
  std::vector<std::uint8_t> take_output() override { return startup_.take_output(); }
  [[nodiscard]] std::vector<std::uint8_t> stop_bytes() const override { return {'Q', 'T', '\n'}; }
  void reset() override;
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] Counters rejected() const override { return finder_.frames().rejected(); }
  [[nodiscard]] std::string identity() const override { return startup_.identity(); }
  [[nodiscard]] std::optional<Error> problem() const override { return startup_.problem(); }

 private:
  void on_reply(const scip::Reply& reply, double arrival);
  void on_measurement(const scip::Measurement& measurement, double arrival);
  [[nodiscard]] LidarScan make_scan(const scip::Measurement& measurement, double t_first,
                                    double period) const;
  void report_reply(const scip::Reply& reply) const;

  LidarOptions options_;
  scip::ReplyFinder finder_;
  scip::Startup startup_;
  DeviceClock clock_;
  StampLine line_;
  std::optional<scip::Parameters> parameters_;
  std::optional<std::uint32_t> last_stamp_;
  double began_ = 0.0;  // s, when the first byte of the reply in progress came
  std::vector<LidarScan> scans_;
  std::uint64_t published_ = 0;
};

}  // namespace odomcalib::drivers
