// Two wheels that follow their commanded rates at once: what a device emulator counts.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace odomcalib::sim {

struct WheelPair {
  std::array<double, 2> rate{};   ///< rad/s, left and right
  std::array<double, 2> angle{};  ///< rad

  void advance(double dt) {
    for (std::size_t side = 0; side < 2; ++side) angle[side] += rate[side] * dt;
  }
  [[nodiscard]] std::int64_t count(std::size_t side, double counts_per_turn) const {
    return std::llround(std::floor(angle[side] / (2.0 * std::numbers::pi) * counts_per_turn));
  }
};

}  // namespace odomcalib::sim
