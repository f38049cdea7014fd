// A Hokuyo sensor with SCIP 2.0: 40 turns a second, 1081 steps of a quarter degree.
#pragma once

#include "tests/sim/wires/lidar_device.hpp"

namespace odomcalib::sim {

class ScipDevice final : public LidarDevice {
 public:
  struct Options {
    std::string product = "SIM-30LX";
    double period = 0.0251;        ///< s; the sensor says 2400 turns a minute
    double clock_zero = 16'776.0;  ///< s on the device's clock at time 0: it wraps at 16777.216 s
    double ready_at = 0.0;         ///< s; before, the laser cannot be switched on
    double still_after = 1e9;      ///< s; from then on the walls stand still
  };
  explicit ScipDevice(const Options& options) : LidarDevice(0.0), options_(options) {}

  void from_host(std::string_view bytes, double now) override;
  void advance(double now) override;
  [[nodiscard]] bool streaming() const { return !stream_.empty(); }

 private:
  void on_line(const std::string& line, double now);
  void reply(const std::string& echo, const std::string& status, const std::vector<std::string>& lines,
             double ready);
  void send_scan(double rear);

  Options options_;
  std::string input_, stream_;
  bool laser_ = false;
  double next_rear_ = 0.0;
};

}  // namespace odomcalib::sim
