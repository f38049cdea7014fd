// Continues counts that wrap at 16, 24 or 32 bits into 64 bits and tells motion from a wild count and from a
// counter that began anew.
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
    enum class Kind {
      motion,    ///< continues the counts before
      wild,      ///< no wheel turns so fast: what it means is known when the next count comes
      restarted  ///< continues a wild one: the counter began anew, and the way in between is not known
    } kind = Kind::motion;
    std::int64_t total = 0;  ///< after a wild count as before it
    /// Motion went on over a wild count: where the wheel was then, by the counts around it.
    struct Between {
      double t = 0.0;  ///< s
      std::int64_t total = 0;
    };
    std::optional<Between> between;
  };
  Reading on_count(std::int64_t count, double t);
  /// The next count is a new beginning; the total goes on.
  void forget();

 private:
  struct Count {
    std::int64_t raw = 0;
    double t = 0.0;  // s
  };
  /// Counts from one to the other; nullopt when no wheel turns so fast.
  [[nodiscard]] std::optional<std::int64_t> motion(const Count& from, const Count& to) const;

  double ticks_per_s_;
  unsigned bits_;
  std::optional<Count> last_, wild_;
  std::int64_t total_ = 0;
};

}  // namespace odomcalib::drivers
