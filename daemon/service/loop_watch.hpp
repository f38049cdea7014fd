// How long the turns of the loop take and what held up the longest one: who was late, the client or we?
#pragma once

#include <poll.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

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

/// Finds a loop that turns without end and gets nowhere: its process is better started anew (specification
/// B7).
class LoopGuard {
 public:
  /// @param names of what is polled, the last one for all that follow it
  explicit LoopGuard(std::span<const char* const> names) : names_(names), lines_(names.size()) {}

  /// A wait for these has ended. @param count what poll() returned: one that fails, and a descriptor that is
  /// not open, make each wait end at once
  void polled(std::span<const pollfd> files, int count);
  /// One turn. @param at_once calls were waiting, so that there was no wait @param served one of them was
  /// taken @param taken of each name, so far: bytes, frames, pieces of work. What wakes the loop and is not
  /// taken wakes it again.
  void turned(bool at_once, bool served, std::span<const std::uint64_t> taken);
  /// The point at which it hangs; empty: none.
  [[nodiscard]] const std::string& hangs_at() const { return hangs_at_; }

 private:
  struct Line {
    bool woke = false;  // the last wait
    std::uint64_t taken = 0;
    std::size_t idle_turns = 0;
  };
  void hangs(std::size_t line, const std::string& how);

  std::span<const char* const> names_;
  std::vector<Line> lines_;
  std::size_t idle_turns_ = 0;
  std::string hangs_at_;
};

}  // namespace odomcalib
