// A Lawicel ASCII adapter on a serial port as a CAN transport.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "drivers/can/transport.hpp"
#include "drivers/serial/port.hpp"

namespace odomcalib::drivers {

struct SlcanOptions {
  unsigned bitrate = 500'000;  ///< bit/s on the CAN side
  /// Baud rate of the serial side. Unset: a USB-CDC device, which sends a line at once whatever rate is set;
  /// frames then carry the time of their arrival, because no transfer time is known.
  std::optional<unsigned> baud;
  bool timestamps = false;  ///< ask the adapter for its own millisecond stamps
};

/// Its ready() closes the adapter's channel, sets the bit rate and opens it again, step by step and without
/// waiting: in 0.1 s, at most 0.9 s with an adapter that acknowledges nothing, which is used, with a note().
/// Errors: usage (bit rate that the protocol has no command for); those of ready(): device (refused,
/// unplugged).
Result<std::unique_ptr<CanTransport>> open_slcan(std::unique_ptr<ByteStream> port, const std::string& name,
                                                 const SlcanOptions& options);

}  // namespace odomcalib::drivers
