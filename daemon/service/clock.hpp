// Time is passed in: the daemon's logic runs against a simulated robot faster than real time.
#pragma once

#include <time.h>

#include <cstdint>

namespace odomcalib {

class Clock {
 public:
  Clock() = default;
  virtual ~Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  /// s, monotonic: for every interval.
  [[nodiscard]] virtual double now() const = 0;
  /// s that the machine has spent suspended, which now() leaves out.
  [[nodiscard]] virtual double suspended() const { return 0.0; }
  /// us since 1970, may step: for people only.
  [[nodiscard]] virtual std::int64_t wall_us() const = 0;
};

class SystemClock : public Clock {
 public:
  [[nodiscard]] double now() const override {
    return static_cast<double>(nanoseconds(CLOCK_MONOTONIC)) * 1e-9;
  }
  [[nodiscard]] double suspended() const override {
    return static_cast<double>(nanoseconds(CLOCK_BOOTTIME) - nanoseconds(CLOCK_MONOTONIC)) * 1e-9;
  }
  [[nodiscard]] std::int64_t wall_us() const override { return nanoseconds(CLOCK_REALTIME) / 1000; }

 private:
  static std::int64_t nanoseconds(clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
  }
};

}  // namespace odomcalib
