// The time of a message: its header's stamp, or when the recorder had it. Internal to proto/.
#pragma once

#include <cstdint>

#include "proto/recording/ros/choice.hpp"

namespace odomcalib::ros {

/// Stamps, unless those of the chosen topics come from different clocks. Times count from a whole second.
class Clock {
 public:
  explicit Clock(const Chosen& chosen);

  [[nodiscard]] bool by_reception() const { return by_reception_; }
  [[nodiscard]] double apart_s() const { return apart_s_; }
  /// s after the start of the recording
  template <typename Value>
  double operator()(const Stamped<Value>& one) const {
    return since_start(time_ns(one.stamp_ns, one.received_ns));
  }

 private:
  [[nodiscard]] std::int64_t time_ns(std::int64_t stamp, std::int64_t received) const;
  [[nodiscard]] double since_start(std::int64_t time) const;
  void set_start(const Topic& topic);

  double apart_s_ = 0.0;
  bool by_reception_ = false;
  std::int64_t start_ = 0;  // ns
};

}  // namespace odomcalib::ros
