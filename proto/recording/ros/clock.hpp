// The time of a message: its header's stamp, or when the recorder had it. Internal to proto/.
#pragma once

#include <cstdint>
#include <string>

#include "proto/recording/ros/choice.hpp"

namespace odomcalib::ros {

/// Gives single messages without a stamp (0) the one that their reception has beside that of their neighbour:
/// a simulation begins at 0. Where most have none, or none is near, they stay as they are. Returns how many.
std::size_t fit_missing_stamps(Topic& topic);

/// Stamps, unless those of a chosen topic are no times or those of two come from different clocks: then the
/// times of reception of all, which are of one clock. Times count from a whole second.
class Clock {
 public:
  explicit Clock(const Chosen& chosen);

  /// Remark on the times; empty for sound stamps.
  [[nodiscard]] const std::string& remark() const { return remark_; }
  /// s since the zero of that clock, at which times begin: a whole second
  [[nodiscard]] double start() const;
  /// s after the start of the recording
  template <typename Value>
  double operator()(const Stamped<Value>& one) const {
    return since_start(time_ns(one.stamp_ns, one.received_ns));
  }

 private:
  void judge(const std::string& reason, bool reception_is_sound);
  [[nodiscard]] std::int64_t time_ns(std::int64_t stamp, std::int64_t received) const;
  [[nodiscard]] double since_start(std::int64_t time) const;
  void set_start(const Topic& topic);

  std::string remark_;
  bool by_reception_ = false;
  std::int64_t start_ = 0;  // ns
};

}  // namespace odomcalib::ros
