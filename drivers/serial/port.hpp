// A serial port opened raw and non-blocking. Device strings: "serial:/dev/ttyUSB0?baud=230400".
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "drivers/byte_stream.hpp"
#include "proto/result.hpp"

namespace odomcalib::drivers {

struct DeviceString {
  std::string scheme;  ///< socketcan, slcan, serial, tcp
  std::string path;    ///< /dev/ttyUSB0, can0, host:port
  std::vector<std::pair<std::string, std::string>> options;
  [[nodiscard]] std::string option(const std::string& key, const std::string& otherwise) const;
};

/// The option "baud". Error usage: missing, or no rate.
Result<unsigned> baud_of(const DeviceString& device);

/// Errors: usage, naming the part that is wrong.
Result<DeviceString> parse_device(const std::string& text);

/// State of the modem lines after opening; on many lidars DTR runs or stops the motor.
struct ModemLines {
  bool dtr = true;
  bool rts = true;
};

/// Opens through libserial (rates it cannot set through termios2), 8N1, raw, exclusive.
Result<std::unique_ptr<ByteStream>> open_serial(const std::string& path, unsigned baud,
                                                const ModemLines& lines = {});

}  // namespace odomcalib::drivers
