// The lidar behind its serial port: opens the port, reopens it after it was lost, carries bytes both ways.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/lidar/lidar.hpp"
#include "drivers/serial/port.hpp"

namespace odomcalib {

class LidarLink {
 public:
  /// Errors: usage (device string, lidar type). The device may be absent.
  static Result<LidarLink> create(const std::string& device, const std::string& type);

  [[nodiscard]] int fd() const { return port_ ? port_->fd() : -1; }
  void step(double now);
  std::vector<Scan> take_scans() { return lidar_->take_scans(); }

  [[nodiscard]] bool connected() const { return port_ != nullptr; }
  [[nodiscard]] const std::optional<Error>& problem() const { return problem_; }
  [[nodiscard]] drivers::Counters counters() const;
  [[nodiscard]] const std::string& device() const { return device_; }

 private:
  LidarLink(std::string device, std::string path, unsigned baud, std::unique_ptr<drivers::Lidar> lidar);
  void open_when_due(double now);
  void lose(const Error& error, double now);

  std::string device_, path_;
  unsigned baud_;
  std::unique_ptr<drivers::Lidar> lidar_;
  std::unique_ptr<drivers::SerialPort> port_;
  std::optional<Error> problem_;
  double next_try_ = 0.0;
  std::uint64_t opened_ = 0;
};

}  // namespace odomcalib
