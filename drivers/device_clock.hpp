// Maps a device's wrapping clock to the caller's clock by the lower envelope of the arrival
// delays: a transport can only add delay, never remove it, so the smallest difference seen is the best
// estimate of the offset.
#pragma once

#include <cstdint>
#include <optional>

namespace odomcalib::drivers {

class DeviceClock {
 public:
  /// @param modulus value at which the device's counter starts again at 0, e.g. 30000
  /// @param tick_s one count, s
  /// @param device_time whether to stay on the device's own clock, for recordings without arrival times
  explicit DeviceClock(std::uint64_t modulus, double tick_s = 1e-3, bool device_time = false)
      : modulus_(modulus), tick_s_(tick_s), device_time_(device_time) {}

  /// @param count stamp, less than the modulus
  /// @param arrival s on the caller's clock, later than or equal to the stamped instant
  /// @return the stamped instant on the caller's clock, never later than arrival
  double to_host(std::uint64_t count, double arrival);

  /// Time of the last stamp, s since the device's zero, without the jumps where its counter starts again.
  [[nodiscard]] double device() const { return device_s_; }
  /// Offset that to_host adds to that, s.
  [[nodiscard]] double offset() const { return offset_; }

  void reset();

 private:
  void unwrap(std::uint64_t count, double arrival);

  std::uint64_t modulus_;
  double tick_s_;
  bool device_time_;
  std::optional<std::uint64_t> last_count_;
  double last_arrival_ = 0.0;
  double device_s_ = 0.0;  // unwrapped
  double offset_ = 0.0;    // s, host - device: the envelope
  double last_device_s_ = 0.0;
};

/// Dates the packets of a lidar that has no clock of its own. Samples are equidistant, so counted samples are
/// the clock: its rate is measured and its offset is the lower envelope of the arrivals, because a transport
/// can only add delay.
class SampleClock {
 public:
  /// @param device_time whether to count samples only, from 0, for recordings without arrival times
  explicit SampleClock(bool device_time) : device_time_(device_time) {}

  struct Stamp {
    double t = 0.0;          ///< s, never later than the arrival
    bool continuous = true;  ///< false after a hole in the stream: what came before does not belong to it
  };

  /// @param nominal time since the packet before, as the number of samples and the nominal rate tell, s
  /// @param arrival of the packet on the caller's clock, s
  Stamp on_packet(double nominal, double arrival);

  /// True length of a nominal second.
  [[nodiscard]] double rate() const { return rate_; }
  void reset();

 private:
  void start(double arrival);
  void learn(double late, double nominal);

  bool device_time_;
  bool running_ = false;
  double t_ = 0.0;     // s, envelope at the last packet
  double rate_ = 1.0;  // measured / nominal
  // Window in progress: nominal seconds in it, and the least lateness seen.
  double window_ = 0.0, least_late_ = 0.0;
};

}  // namespace odomcalib::drivers
