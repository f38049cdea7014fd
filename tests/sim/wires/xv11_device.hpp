// The lidar of a Neato XV-11, turned by its motor at an even speed.
#pragma once

#include "tests/sim/wires/lidar_device.hpp"

namespace odomcalib::sim {

class Xv11Device final : public LidarDevice {
 public:
  struct Options {
    double turns_per_second = 5.1;
    double told_error = 0.01;  ///< of the speed that it tells
  };
  explicit Xv11Device(const Options& options) : LidarDevice(11'520.0), options_(options) {}

  void from_host(std::string_view, double) override {}
  void advance(double now) override;

 private:
  Options options_;
  unsigned packet_ = 30;
  double next_ = 0.0;
};

}  // namespace odomcalib::sim
