// Small conversions that every lidar driver needs.
#pragma once

#include <cstddef>
#include <limits>
#include <numbers>

namespace odomcalib::drivers {

inline constexpr double kNoReading = std::numeric_limits<double>::quiet_NaN();

constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

/// Time that bytes take on a serial line with 8N1, s; 0 on a network.
constexpr double wire_time(std::size_t bytes, unsigned baud) {
  return baud == 0 ? 0.0 : 10.0 * static_cast<double>(bytes) / baud;
}

}  // namespace odomcalib::drivers
