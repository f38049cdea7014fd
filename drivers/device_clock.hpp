// Maps a device's wrapping millisecond clock to the caller's clock by the lower envelope of the arrival
// delays: a transport can only add delay, never remove it, so the smallest difference seen is the best
// estimate of the offset.
#pragma once

#include <cstdint>
#include <optional>

namespace odomcalib::drivers {

class DeviceClock {
 public:
  /// @param modulus_ms value at which the device's counter starts again at 0, e.g. 30000
  explicit DeviceClock(std::uint32_t modulus_ms) : modulus_ms_(modulus_ms) {}

  /// @param device_ms stamp, less than the modulus
  /// @param arrival s on the caller's clock, later than or equal to the stamped instant
  /// @return the stamped instant on the caller's clock, never later than arrival
  double to_host(std::uint32_t device_ms, double arrival);

  void reset();

 private:
  void unwrap(std::uint32_t device_ms, double arrival);

  std::uint32_t modulus_ms_;
  std::optional<std::uint32_t> last_ms_;
  double last_arrival_ = 0.0;
  double device_s_ = 0.0;  // unwrapped
  double offset_ = 0.0;    // s, host - device: the envelope
  double last_device_s_ = 0.0;
};

}  // namespace odomcalib::drivers
