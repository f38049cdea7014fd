// A YDLIDAR with the triangle protocol.
#pragma once

#include "tests/sim/wires/lidar_device.hpp"

namespace odomcalib::sim {

class YdlidarDevice final : public LidarDevice {
 public:
  struct Options {
    bool answers = true;  ///< takes commands; otherwise it only talks
    bool triangulates = true;
    bool intensity = false;         ///< a byte before each sample
    double samples_per_s = 5000.0;  ///< nominal
    double clock_error = -0.006;    ///< true sample time / nominal sample time - 1
    double turns_per_second = 6.4;
    double bytes_per_s = 12'800.0;
  };
  explicit YdlidarDevice(const Options& options)
      : LidarDevice(options.bytes_per_s), options_(options), scanning_(!options.answers) {}

  void from_host(std::string_view bytes, double now) override;
  void advance(double now) override;
  [[nodiscard]] bool scanning() const { return scanning_; }

 private:
  struct Sample {
    double clockwise = 0.0;  // degrees, as the device counts
    double range_mm = 0.0;
  };
  void measure(double t);
  void send_packet(bool zero, double t);

  Options options_;
  std::string input_;
  bool scanning_;
  double next_ = 0.0, previous_ = 0.0;
  std::vector<Sample> samples_;
};

}  // namespace odomcalib::sim
