// A connection that carries bytes both ways without ever blocking: a serial port or a TCP socket.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "proto/result.hpp"

namespace odomcalib::drivers {

class ByteStream {
 public:
  virtual ~ByteStream() = default;
  /// To poll for reading.
  [[nodiscard]] virtual int fd() const = 0;
  /// False while a connection is still being made. Error device: it was refused.
  virtual Result<bool> connected() { return true; }
  /// Whatever has arrived; empty when nothing has. Error device: unplugged, or closed by the other side.
  virtual Result<std::vector<std::uint8_t>> read() = 0;
  /// Never blocks. Error device: unplugged, or the output buffer is full: then all of it was dropped.
  virtual Result<void> write(std::span<const std::uint8_t> bytes) = 0;
};

}  // namespace odomcalib::drivers
