// From the counts of two wheels on the wire to tick samples, the same for every driver and for `decode`:
// wraps are continued, a wild count gives way to what lies between the counts around it, a counter that began
// anew begins a segment, mirrored motors are turned round, and counts that come in separate messages are
// brought to common instants.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "drivers/base/motion/tick_pairing.hpp"
#include "drivers/base/motion/tick_unwrap.hpp"
#include "drivers/base/profile/profile.hpp"
#include "drivers/can/transport.hpp"  // Counters
#include "proto/measurements.hpp"

namespace odomcalib::drivers {

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
