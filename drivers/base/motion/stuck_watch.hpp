// Tells a count that stands still although its wheel is commanded to turn: a broken encoder would let the
// robot run away. Two cases. A wheel that has not broken away yet (friction, play in the gear, a slow ramp)
// may rightly stand for a while. One that was turning and is commanded to go on has no reason to: its count
// must not stand for longer than the command needs for some counts.
#pragma once

#include <cstdint>

namespace odomcalib::drivers {

class StuckWatch {
 public:
  explicit StuckWatch(double ticks_per_rev);

  /// Torque is on; nothing was commanded or counted before.
  void begin(double now);
  /// The speed in force; to be called at least every 20 ms.
  void commanded(double rad_s, double now);
  /// A reading of the count.
  /// @param forward counts, positive in the direction of positive commands
  /// @param t s, when the device took it; @param now s, when it arrived
  void counted(std::int64_t forward, double t, double now);
  [[nodiscard]] bool stuck(double now) const;

 private:
  void turn_to(int direction);
  [[nodiscard]] bool never_left(double now) const;
  [[nodiscard]] bool froze() const;

  double tick_rad_;
  double rate_ = 0.0, commanded_at_ = 0.0;   // command in force, rad/s; s
  int direction_ = 0;                        // of the command
  std::int64_t count_ = 0, began_at_ = 0;    // now; when the direction was first commanded
  double changed_at_ = 0.0;                  // s, arrival of the last count that differed
  double expected_rad_ = 0.0;                // commanded since then
  bool turning_ = false;                     // has broken away in this direction
  double lowest_ = 0.0;                      // rad/s, least command since the count changed
  double changed_t_ = 0.0, sample_t_ = 0.0;  // s, device's dates: last change, last reading
  unsigned same_ = 0;                        // readings since the change
  double longest_pause_ = 0.0;               // s between two changes while turning
};

}  // namespace odomcalib::drivers
