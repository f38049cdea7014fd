// A SLAMTEC RPLIDAR: answers requests, sends standard nodes, express or dense capsules.
#pragma once

#include "tests/sim/wires/lidar_device.hpp"

namespace odomcalib::sim {

class RplidarDevice final : public LidarDevice {
 public:
  enum class Data { standard, express, dense };
  struct Options {
    Data data = Data::express;   ///< of the typical mode
    bool configurable = true;    ///< firmware 1.29; otherwise 1.20, which has one express mode only
    double sample_s = 250e-6;    ///< as told
    double clock_error = 0.004;  ///< true sample time / told sample time - 1
    double turns_per_second = 7.3;
    int health = 0;  ///< 2: error until reset
    double bytes_per_s = 11'520.0;
  };
  explicit RplidarDevice(const Options& options) : LidarDevice(options.bytes_per_s), options_(options) {}

  void from_host(std::string_view bytes, double now) override;
  void advance(double now) override;
  [[nodiscard]] bool scanning() const { return scanning_; }
  int resets = 0;

 private:
  struct Sample {
    double clockwise = 0.0;  // degrees
    double range_mm = 0.0;
  };
  void on_request(int command, std::string_view payload, double now);
  void answer(int type, const std::string& payload, double now);
  void start(Data data, double now);
  void measure(double t);
  void pack(double t);
  std::string express_capsule() const;
  std::string dense_capsule() const;

  Options options_;
  std::string input_;
  bool scanning_ = false, first_ = true;
  Data data_ = Data::standard;
  double next_ = 0.0, previous_angle_ = 0.0;
  std::vector<Sample> samples_;
};

}  // namespace odomcalib::sim
