// Continues wrapping 32-bit counts into 64 bits and tells a jump or a reset from motion.
#pragma once

#include <cstdint>
#include <optional>

namespace odomcalib::drivers {

class TickUnwrap {
 public:
  /// @param ticks_per_s at the highest speed the drive can turn; 1.5 times this is still taken for motion
  explicit TickUnwrap(double ticks_per_s) : ticks_per_s_(ticks_per_s) {}

  struct Reading {
    std::int64_t total = 0;
    bool jumped = false;  ///< counts could not be continued: total goes on without the jump
  };
  Reading on_count(std::int32_t raw, double t);
  /// The next count is a new beginning; the total goes on.
  void forget() { last_.reset(); }

 private:
  double ticks_per_s_;
  std::optional<std::int32_t> last_;
  double last_t_ = 0.0;
  std::int64_t total_ = 0;
};

}  // namespace odomcalib::drivers
