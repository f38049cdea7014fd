// One interface for every way onto a CAN bus. Devices: "socketcan:can0", "slcan:/dev/ttyACM0?bitrate=500000".
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "proto/result.hpp"

namespace odomcalib::drivers {

struct CanFrame {
  std::uint32_t id = 0;
  bool extended = false;  ///< 29-bit identifier
  bool remote = false;
  bool error = false;  ///< error frame of the interface (bus-off, error-passive, ...), not from a node
  std::uint8_t length = 0;
  std::array<std::uint8_t, 8> data{};
  double t = 0.0;  ///< s on the caller's clock, best estimate of the frame's reception
};

/// Named counters, shown by `odomcalibctl status`. Byte streams keep bytes_in = good + skipped + buffered.
using Counters = std::map<std::string, std::uint64_t>;

class CanTransport {
 public:
  virtual ~CanTransport() = default;
  /// File descriptor to poll for reading; -1 when closed.
  [[nodiscard]] virtual int fd() const = 0;
  /// False while an adapter is still being set up: call it every few ms until then, and nothing else. Never
  /// blocks. Error device: refused, unplugged.
  /// @param now s on the caller's clock
  virtual Result<bool> ready(double /*now*/) { return true; }
  /// Queues or sends one frame; never blocks. Error device: the bus or port is gone, or the queue is full.
  virtual Result<void> send(const CanFrame& frame) = 0;
  /// Everything received up to now. Error device: unplugged, interface down, bus-off.
  /// @param now s on the caller's clock; used for stamps where the kernel gives none
  virtual Result<std::vector<CanFrame>> receive(double now) = 0;
  [[nodiscard]] virtual Counters counters() const = 0;
  /// Bytes or frames that were taken from the line so far, whatever became of them.
  [[nodiscard]] virtual std::uint64_t taken() const = 0;
  /// Notice for people about a bus that is open all the same; empty: none.
  [[nodiscard]] virtual std::string note() const { return {}; }
};

/// Opens a device string without waiting for what is behind it: see CanTransport::ready(). Errors: usage (bad
/// string), device (cannot open; the remedy names the command to try).
Result<std::unique_ptr<CanTransport>> open_can(const std::string& device);

}  // namespace odomcalib::drivers
