// How long the turns of the loop take and what held up the longest one: who was late, the client or we?
#pragma once

#include <cstdint>
#include <string>

namespace odomcalib {

class LoopWatch {
 public:
  struct Longest {
    double seconds = 0.0;  ///< s, from turn to turn without the time that it wanted to wait
    std::string part;      ///< that took most of it
    double at = 0.0;       ///< s, monotonic, its end
  };

  /// A turn begins: the loop goes to wait for input, at most `wait` s.
  void begin(double now, double wait);
  /// The part that just ended; the time since the part before it is its own. The wait's is what it overran.
  void passed(const char* part, double now);
  void end(double now);
  /// A motion begins: its longest turn is looked for.
  void motion_begins() { motion_ = {}; }

  /// A control step came noticeably late.
  void step_was_late() { ++late_steps_; }

  [[nodiscard]] std::uint64_t turns() const { return turns_; }
  [[nodiscard]] std::uint64_t late_steps() const { return late_steps_; }
  [[nodiscard]] const Longest& since_start() const { return ever_; }
  [[nodiscard]] const Longest& in_motion() const { return motion_; }

 private:
  double mark_ = 0.0, wait_ = 0.0, worst_ = 0.0;
  Longest turn_, ever_, motion_;
  std::uint64_t turns_ = 0, late_steps_ = 0;
};

}  // namespace odomcalib
