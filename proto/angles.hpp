// Angles are in radians everywhere; people read degrees.
#pragma once

#include <numbers>

namespace odomcalib {

inline constexpr double kDegrees = 180.0 / std::numbers::pi;  ///< degrees in a radian

}  // namespace odomcalib
