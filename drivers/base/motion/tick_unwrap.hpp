// Continues counts that wrap at 16, 24 or 32 bits into 64 bits and tells a jump or a reset from motion.
#pragma once

#include <cstdint>
#include <optional>

namespace odomcalib::drivers {

class TickUnwrap {
 public:
  /// @param ticks_per_s at the highest speed the drive can turn; 1.5 times this is still taken for motion
  /// @param bits width of the counter in the device; higher bits of a count are ignored
  explicit TickUnwrap(double ticks_per_s, unsigned bits = 32) : ticks_per_s_(ticks_per_s), bits_(bits) {}

  struct Reading {
    std::int64_t total = 0;
    bool jumped = false;  ///< counts could not be continued: total goes on without the jump
  };
  Reading on_count(std::int64_t count, double t);
  /// The next count is a new beginning; the total goes on.
  void forget() { last_.reset(); }

 private:
  double ticks_per_s_;
  unsigned bits_;
  std::optional<std::int64_t> last_;
  double last_t_ = 0.0;
  std::int64_t total_ = 0;
};

}  // namespace odomcalib::drivers
