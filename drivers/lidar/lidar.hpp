// What every 2D lidar looks like to the daemon: bytes and time in, scans out. No file descriptor, no clock.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "drivers/can/transport.hpp"  // Counters
#include "proto/measurements.hpp"
#include "proto/result.hpp"

namespace odomcalib::drivers {

class Lidar {
 public:
  virtual ~Lidar() = default;
  /// @param now s on the caller's clock when the bytes were read; scan times are on the same clock
  virtual void on_bytes(std::span<const std::uint8_t> bytes, double now) = 0;
  /// Complete scans since the last call, first beam's time in Scan::t. The first, partial sweep is dropped.
  virtual std::vector<Scan> take_scans() = 0;
  /// Bytes to send to the device (start commands); empty for devices that talk by themselves.
  virtual std::vector<std::uint8_t> take_output() = 0;
  /// Forget everything buffered, e.g. after the port was lost.
  virtual void reset() = 0;
  /// Includes bytes_in, good, skipped, buffered and one counter per kind of rejection.
  [[nodiscard]] virtual Counters counters() const = 0;
};

/// @param type "ld06" (also "ld19")
/// @param baud of the serial line, used to date packets inside one read
Result<std::unique_ptr<Lidar>> make_lidar(const std::string& type, unsigned baud);

}  // namespace odomcalib::drivers
