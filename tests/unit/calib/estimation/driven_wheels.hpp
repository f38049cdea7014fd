// Wheels that turn both ways at many speeds, for tests of estimators without a room.
#pragma once

#include <cmath>

#include "calib/wheels/wheel_motion.hpp"
#include "calib/wheels/wheel_track.hpp"

namespace odomcalib::calib::estimation {

inline const wheels::BaseParameters kTruth{0.0753, 0.0747, 0.407, {0.11, -0.015, 0.05}};
inline const wheels::BaseParameters kNominal{0.075, 0.075, 0.4, {0.1, 0.0, 0.0}};

/// @param duration s, sampled every 20 ms
inline wheels::WheelTrack drive(double duration) {
  wheels::WheelTrack track;
  for (int k = 0; k * 0.02 <= duration; ++k) {
    const double t = 0.02 * k;
    track.t.push_back(t);
    track.left.push_back(9.0 * std::sin(0.29 * t) + 4.0 * std::sin(0.11 * t));
    track.right.push_back(9.0 * std::sin(0.37 * t) + 4.0 * std::sin(0.13 * t + 1.0));
    track.segment.push_back(0);
  }
  return track;
}

}  // namespace odomcalib::calib::estimation
