// Finds a loop that turns without end and gets nowhere: its process is better started anew (specification
// B7).
#pragma once

#include <poll.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace odomcalib {

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
