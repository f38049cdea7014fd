// A recording of a robot that was driven about and watched by motion capture, made without the library.
#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "calib/math/se2.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::test_support {

inline constexpr unsigned kDriveSeed = 20;
inline constexpr double kLeftRadius = 0.0755, kRightRadius = 0.0745, kTrackWidth = 0.41;  // m

/// Two minutes of arcs and turns, nominal values a few per cent off.
/// @param marker pose on the base of what is tracked
/// @param turning share of the turns; 0: straight ahead
inline Recording driven_recording(const calib::math::Pose& marker, double turning = 1.0) {
  constexpr double kStep = 1e-3, kPi = 3.14159265358979323846, kCounts = 65536.0;
  Recording recording;
  recording.name = "driven";
  recording.robot = {0.15, 0.15, 0.4, kCounts, std::nullopt, "", ""};
  std::mt19937 engine(kDriveSeed);
  std::normal_distribution<double> error(0.0, 5e-4);  // m and rad
  double left = 0.0, right = 0.0, x = 0.0, y = 0.0, yaw = 0.0;
  for (int k = 0; k <= 120000; ++k) {
    const double t = kStep * k;
    const double bend = turning * (2.0 * std::sin(0.17 * t) + 1.5 * std::sin(0.41 * t));
    const double forward = 3.0 * std::sin(0.23 * t + 0.3) + 1.0;
    if (k % 20 == 0)
      recording.ticks.push_back(
          {t, std::llround(left / (2.0 * kPi) * kCounts), std::llround(right / (2.0 * kPi) * kCounts), 0});
    if (k % 100 == 0)
      recording.poses.push_back({t, x + std::cos(yaw) * marker.x - std::sin(yaw) * marker.y + error(engine),
                                 y + std::sin(yaw) * marker.x + std::cos(yaw) * marker.y + error(engine),
                                 yaw + marker.yaw + error(engine)});
    const double left_step = (forward - bend) * kStep, right_step = (forward + bend) * kStep;
    const double way = 0.5 * (kRightRadius * right_step + kLeftRadius * left_step);
    const double turn = (kRightRadius * right_step - kLeftRadius * left_step) / kTrackWidth;
    x += way * std::cos(yaw + 0.5 * turn);
    y += way * std::sin(yaw + 0.5 * turn);
    yaw += turn;
    left += left_step;
    right += right_step;
  }
  return recording;
}

}  // namespace odomcalib::test_support
