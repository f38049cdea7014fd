// Finds a loop that turns without end and gets nowhere: its process is better started anew (specification
// B7).
#pragma once

#include <poll.h>

#include <span>
#include <string>

namespace odomcalib {

class LoopGuard {
 public:
  /// @param names of what is polled, the last one for all that follow it
  explicit LoopGuard(std::span<const char* const> names) : names_(names) {}

  /// What was polled for: a descriptor that is not open makes each wait end at once.
  void polled(std::span<const pollfd> files);
  /// One turn. @param at_once calls were waiting, so that there was no wait @param served one of them was
  /// taken
  void turned(bool at_once, bool served);
  /// What it hangs at; empty: nothing.
  [[nodiscard]] const std::string& hangs_at() const { return hangs_at_; }

 private:
  std::span<const char* const> names_;
  std::size_t idle_turns_ = 0;
  std::string hangs_at_;
};

}  // namespace odomcalib
