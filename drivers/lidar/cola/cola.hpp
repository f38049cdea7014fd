// SICK LMS1xx, LMS5xx, TiM5xx, TiM7xx, MRS1000: CoLa over TCP, counter-clockwise, microsecond clock.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "drivers/device_clock.hpp"
#include "drivers/lidar/cola/settings.hpp"
#include "drivers/lidar/cola/startup.hpp"
#include "drivers/lidar/common/stamp_line.hpp"
#include "drivers/lidar/lidar.hpp"

namespace odomcalib::drivers {

class Cola final : public Lidar {
 public:
  explicit Cola(const LidarOptions& options);

  void on_bytes(std::span<const std::uint8_t> bytes, double now) override;
  std::vector<LidarScan> take_scans() override { return std::exchange(scans_, {}); }
  std::vector<std::uint8_t> take_output() override { return startup_.take_output(); }
  [[nodiscard]] std::vector<std::uint8_t> stop_bytes() const override { return startup_.stop_bytes(); }
  void reset() override;
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] Counters rejected() const override { return finder_.frames().rejected(); }
  [[nodiscard]] std::string identity() const override { return startup_.identity(); }
  [[nodiscard]] std::optional<Error> problem() const override;

 private:
  void on_telegram(const cola::Telegram& telegram, double arrival);
  void on_scan(const cola::ScanData& data, double arrival);
  bool is_repeated(const cola::ScanData& data);
  double date(const cola::ScanData& data, double arrival, double sweep_turns);
  std::uint64_t lost_scans(unsigned between);
  void report_telegram(const cola::Telegram& telegram) const;

  LidarOptions options_;
  cola::TelegramFinder finder_;
  cola::Startup startup_;
  DeviceClock clock_;
  StampLine line_;
  std::optional<std::tuple<unsigned, unsigned, int>> last_counters_;  // telegram, scan, layer
  std::set<int> layers_;                                              // seen
  unsigned turns_per_scan_ = cola::kMostLayers;                       // of one layer, the fewest seen
  unsigned status_ = 0;
  double began_ = 0.0;  // s, when the first byte of the telegram in progress came
  std::vector<LidarScan> scans_;
  std::uint64_t published_ = 0;
};

}  // namespace odomcalib::drivers
