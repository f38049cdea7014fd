// A way onto a CAN bus for tests that have nothing else to do while its adapter is set up.
#pragma once

#include <poll.h>

#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "drivers/can/transport.hpp"

namespace odomcalib::drivers::test {

/// Waits until it is ready, at most 5 s.
inline Result<std::unique_ptr<CanTransport>> ready(Result<std::unique_ptr<CanTransport>> opened) {
  using Clock = std::chrono::steady_clock;
  if (!opened) return opened;
  for (const auto begin = Clock::now();;) {
    const double now = std::chrono::duration<double>(Clock::now() - begin).count();
    const auto done = opened.value()->ready(now);
    if (!done) return done.error();
    if (done.value()) return opened;
    if (now > 5.0) return Error{ErrorCode::timeout, "is not ready", "adapter", ""};
    pollfd state{opened.value()->fd(), POLLIN, 0};
    poll(&state, 1, 2);
  }
}

/// open_can() and the set-up of the adapter.
inline Result<std::unique_ptr<CanTransport>> open_ready_can(const std::string& device) {
  return ready(open_can(device));
}

}  // namespace odomcalib::drivers::test
