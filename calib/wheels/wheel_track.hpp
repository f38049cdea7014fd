// Wheel rotation as a function of time, from tick samples or tuple files.
#pragma once

#include <cstddef>
#include <vector>

#include "proto/recording.hpp"

namespace odomcalib::calib {

/// Cumulative wheel angles in rad at strictly increasing times. Between samples the wheels turn at constant
/// speed.
struct WheelTrack {
  std::vector<double> t;
  std::vector<double> left;
  std::vector<double> right;
  std::vector<int> segment;  ///< motion is unknown across a change of segment
  double tick_period = 0.0;  ///< s, median, of ticks that were sampled more finely; 0: they were not
  double tick_angle = 0.0;   ///< rad, of one count

  [[nodiscard]] bool empty() const { return t.size() < 2; }
  /// Index k with t[k] <= time < t[k+1], clamped to the valid intervals.
  [[nodiscard]] std::size_t interval_at(double time) const;
  /// True when [from, to] lies inside the samples and no segment changes in it.
  [[nodiscard]] bool covers(double from, double to) const;
};

/// Ticks of a recording as wheel angles; samples that do not advance in time are skipped.
WheelTrack wheel_track_from_ticks(const Recording& recording);

/// Tuples laid end to end on one time axis; sample k is the start of tuple k.
WheelTrack wheel_track_from_increments(const Recording& recording);

}  // namespace odomcalib::calib
