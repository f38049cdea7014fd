// A serial port opened raw and non-blocking. Device strings: "serial:/dev/ttyUSB0?baud=230400".
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "proto/result.hpp"

namespace odomcalib::drivers {

class SerialPort {
 public:
  virtual ~SerialPort() = default;
  [[nodiscard]] virtual int fd() const = 0;
  /// Whatever has arrived; empty when nothing has. Error device: unplugged.
  virtual Result<std::vector<std::uint8_t>> read() = 0;
  /// Never blocks. Error device: unplugged, or the output buffer is full.
  virtual Result<void> write(std::span<const std::uint8_t> bytes) = 0;
};

struct DeviceString {
  std::string scheme;  ///< socketcan, slcan, serial, tcp
  std::string path;    ///< /dev/ttyUSB0, can0, host:port
  std::vector<std::pair<std::string, std::string>> options;
  [[nodiscard]] std::string option(const std::string& key, const std::string& otherwise) const;
};

/// Errors: usage, naming the part that is wrong.
Result<DeviceString> parse_device(const std::string& text);

/// Opens through libserial (rates it cannot set through termios2), 8N1, raw, exclusive.
Result<std::unique_ptr<SerialPort>> open_serial(const std::string& path, unsigned baud);

}  // namespace odomcalib::drivers
