// Memory of the way the robot moved lately.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace odomcalib::calib::vehicle {

/// Spans over which the memory of a motion fades, the usual one second: nobody knows how long a robot
/// remembers.
inline constexpr std::array<double, 8> kMemorySpans = {0.3, 1.0, 3.3, 0.2, 0.45, 0.67, 1.5, 2.2};
inline constexpr std::size_t kUsualMemory = 1;
using Memory = std::array<double, kMemorySpans.size()>;

/// m/s^2; what an acceleration of such size moved stays until one the other way (the relay of Krasnosel'skii
/// and Pokrovskii, Systems with Hysteresis, 1989, section 28, its thresholds symmetrical).
inline constexpr std::array<double, 13> kAccelerationThresholds = {0.1,  0.12, 0.145, 0.17, 0.205, 0.25, 0.3,
                                                                   0.36, 0.43, 0.5,   0.6,  0.75,  0.9};
/// Means as in Memory, then relays.
struct AccelerationMemory {
  Memory means{};
  std::array<std::int8_t, kAccelerationThresholds.size()> relays{};  ///< -1, 0 or 1

  [[nodiscard]] static constexpr std::size_t size() {
    return kMemorySpans.size() + kAccelerationThresholds.size();
  }
  double operator[](std::size_t k) const { return k < means.size() ? means[k] : relays[k - means.size()]; }
};

class PreviousTurn {
 public:
  [[nodiscard]] const Memory& value() const { return memory_; }
  /// @param yaw rad, turned in an interval
  void advance(double yaw);

 private:
  Memory memory_{};
};

class PreviousAcceleration {
 public:
  [[nodiscard]] const AccelerationMemory& value() const { return memory_; }
  /// @param acceleration m/s^2, forward
  /// @param peak m/s^2, which it comes to before it falls below the least threshold
  /// @param dt s
  void advance(double acceleration, double peak, double dt);

 private:
  AccelerationMemory memory_{};
};

}  // namespace odomcalib::calib::vehicle
