// A drive with everything in it that effects look at.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "proto/recording/recording.hpp"

namespace odomcalib::test_support {

inline const RobotDescription kRobot{0.15, 0.15, 0.4, 16384.0, std::nullopt, "", ""};

/// Straights, spins and arcs both ways at two paces, each from rest to rest; counts begin anywhere.
inline Recording some_drive() {
  constexpr std::array<std::array<double, 2>, 6> kMoves{
      {{2.7, 2.7}, {-2.7, -2.7}, {-1.6, 1.6}, {1.6, -1.6}, {1.0, 2.6}, {-2.0, -0.4}}};
  Recording recording;
  recording.robot = kRobot;
  double left = 5000.0;
  double right = -70000.0;
  for (int k = 0; k < 3000; ++k) {
    const double t = 0.02 * k;
    recording.ticks.push_back({t, std::llround(left), std::llround(right), 0});
    const double phase = std::fmod(t, 5.0);
    const auto move = static_cast<std::size_t>(t / 5.0);
    const double pace = (move / kMoves.size()) % 2 == 0 ? 1.0 : 0.4;
    const double ramp = std::clamp(std::min(phase, 4.6 - phase), 0.0, 1.0) * pace;
    const double per_step = 0.02 * ramp * kRobot.ticks_per_rev / (2.0 * std::numbers::pi);
    left += per_step * kMoves.at(move % kMoves.size())[0];
    right += per_step * kMoves.at(move % kMoves.size())[1];
  }
  return recording;
}

}  // namespace odomcalib::test_support
