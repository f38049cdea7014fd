// Rule M13: a motion cannot end without the stop, whatever ends it.
#pragma once

#include <functional>
#include <utility>

namespace odomcalib::safety {

/// Calls `stop` exactly once, at the latest on destruction.
class StopGuard {
 public:
  explicit StopGuard(std::function<void()> stop) : stop_(std::move(stop)) {}
  ~StopGuard() { stop(); }
  StopGuard(const StopGuard&) = delete;
  StopGuard& operator=(const StopGuard&) = delete;
  void stop() noexcept {
    if (auto action = std::exchange(stop_, nullptr)) action();
  }

 private:
  std::function<void()> stop_;
};

}  // namespace odomcalib::safety
