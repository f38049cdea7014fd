// Interface of every 2D lidar to the daemon: bytes and time in, scans and bytes out. No file descriptor, no
// clock.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "drivers/can/transport.hpp"  // Counters
#include "proto/measurements.hpp"
#include "proto/result.hpp"

namespace odomcalib::drivers {

struct LidarScan {
  Scan scan;
  std::optional<double> device_time;     ///< s on the device's own clock, as it stamped the scan
  std::optional<std::uint64_t> counter;  ///< of the device
  bool partial = false;                  ///< not a whole turn: to be shown, not to be used
};

/// Anything else a device says, for people and `odomcalibctl decode`.
struct LidarMessage {
  using Value =
      std::variant<std::int64_t, double, std::string, std::vector<double>, std::vector<std::int64_t>>;
  std::string name;
  std::vector<std::pair<std::string, Value>> fields;  ///< in a vector of double NaN means no reading
  bool is_packet = false;  ///< part of a turn: of interest only where no whole turn came of it
};

struct LidarOptions {
  unsigned baud = 0;         ///< of the serial line, used to date packets inside one read; 0: network
  bool device_time = false;  ///< a recording without arrival times: all times are the device's own
};

class Lidar {
 public:
  virtual ~Lidar() = default;
  /// Also called with no bytes at all, so that time passes.
  /// @param now s on the caller's clock when the bytes were read; scan times are on the same clock
  virtual void on_bytes(std::span<const std::uint8_t> bytes, double now) = 0;
  /// Scans since the last call, first beam's time in Scan::t.
  virtual std::vector<LidarScan> take_scans() = 0;
  /// Bytes to send to the device: the dialogue that identifies, configures and starts it.
  virtual std::vector<std::uint8_t> take_output() { return {}; }
  /// Bytes that stop the device, to be sent before the connection is closed on purpose.
  [[nodiscard]] virtual std::vector<std::uint8_t> stop_bytes() const { return {}; }
  /// The connection was lost or is new: forget everything buffered and begin the dialogue again.
  virtual void reset() = 0;
  /// The recording ends: gives out what was gathered of the turn in progress, as partial.
  virtual void finish() {}
  /// Includes bytes_in, good, skipped, buffered and one counter per kind of rejection.
  [[nodiscard]] virtual Counters counters() const = 0;
  /// The rejections among them.
  [[nodiscard]] virtual Counters rejected() const = 0;
  /// Model, firmware, serial number as the device told them; empty before.
  [[nodiscard]] virtual std::string identity() const { return {}; }
  /// Fault that the device itself reports, or that it does not answer; with code format, a fault of its data.
  [[nodiscard]] virtual std::optional<Error> problem() const { return std::nullopt; }

  using Listener = std::function<void(LidarMessage)>;
  void set_listener(Listener listener) { listener_ = std::move(listener); }

 protected:
  [[nodiscard]] bool has_listener() const { return listener_ != nullptr; }
  void report(LidarMessage message) const {
    if (listener_) listener_(std::move(message));
  }

 private:
  Listener listener_;
};

/// @param type a name of lidar_types(), e.g. "ld06", "ydlidar:x4"
Result<std::unique_ptr<Lidar>> make_lidar(const std::string& type, const LidarOptions& options);

/// Properties of a type that the daemon must know before it opens the device.
struct LidarType {
  std::string name;
  unsigned baud = 0;   ///< usual rate of the serial line; 0: the network only
  unsigned port = 0;   ///< usual TCP port; 0: the serial line only
  bool dtr = true;     ///< state of DTR that lets the motor run
  std::string models;  ///< for people
};

const std::vector<LidarType>& lidar_types();
/// "ld06, ld19, ...", for messages.
std::string lidar_type_names();
/// Errors: usage, naming what is known.
Result<LidarType> find_lidar_type(const std::string& name);

}  // namespace odomcalib::drivers
