// From the counts of two wheels on the wire to tick samples, the same for every driver and for `decode`:
// wraps are continued, a wild count gives way to what lies between the counts around it, a counter that began
// anew begins a segment, mirrored motors are turned round, and counts that come in separate messages are
// brought to common instants.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "drivers/base/profile/profile.hpp"
#include "drivers/can/transport.hpp"  // Counters
#include "proto/measurements.hpp"

namespace odomcalib::drivers {

enum class Side : std::uint8_t { left = 0, right = 1 };

/// A pair is dated by its left count. The right count is the one of the same instant, or interpolated between
/// the two right counts around it, rounded to a whole count: late by at most one period, never extrapolated.
class TickPairing {
 public:
  struct Pair {
    double t = 0.0;
    std::int64_t left = 0, right = 0;
  };

  /// @param t dates of one side never go back
  /// @return the pair that became complete
  std::optional<Pair> add(Side side, double t, std::int64_t count);
  /// Counts were reset: nothing is interpolated across.
  void forget();
  /// Left counts for which no right ones came in time.
  [[nodiscard]] std::uint64_t unpaired() const { return unpaired_; }

 private:
  struct Count {
    double t = 0.0;
    std::int64_t value = 0;
  };
  std::optional<Pair> pair_between(const Count& before, const Count& after);

  std::optional<Count> waiting_left_, last_right_;
  std::uint64_t unpaired_ = 0;
};

/// Continues counts that wrap at 16, 24 or 32 bits into 64 bits and tells motion from a wild count and from a
/// counter that began anew.
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

const char* to_text(Side side);

class WheelCounts {
 public:
  /// @param profile gives the highest speed, the width of the counters and the mounting
  explicit WheelCounts(const Profile& profile);

  struct Reading {
    TickUnwrap::Reading::Kind kind = TickUnwrap::Reading::Kind::motion;
    std::int64_t forward = 0;  ///< total, positive where the wheel turned forward
  };
  /// @param raw as the device counts
  /// @param t s, when the device took it; dates of one side never go back
  Reading on_count(Side side, std::int64_t raw, double t);
  /// The device was lost or begins anew: nothing is continued or interpolated across.
  void begin_segment();

  /// Samples of both wheels since the last call.
  std::vector<TickSample> take() { return std::exchange(samples_, {}); }
  /// Adds tick_jumps (wild counts), unpaired_counts and events_dropped (samples that nobody took).
  void count_into(Counters& counters) const;

 private:
  void add(Side side, double t, std::int64_t forward);

  std::array<TickUnwrap, 2> unwrap_;
  std::array<int, 2> sign_;
  TickPairing pairing_;
  std::int32_t segment_ = 0;
  std::vector<TickSample> samples_;
  std::uint64_t wild_ = 0, dropped_ = 0;
};

}  // namespace odomcalib::drivers
