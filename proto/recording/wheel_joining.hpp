// Wheels that are told one by one, each with times of its own, brought to one instant. Internal to proto/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "proto/measurements.hpp"

namespace odomcalib {

enum class Side : std::uint8_t { left, right };
inline const char* name_of(Side side) { return side == Side::left ? "left" : "right"; }

/// One wheel at one instant.
struct SideSample {
  double t = 0.0;      ///< s
  double value = 0.0;  ///< rad or rad/s
};

/// Meaning of a value between two samples.
enum class Between : std::uint8_t {
  linear,  ///< angles; those that a driver keeps within one turn are continued first
  held     ///< speeds
};

struct JoinedWheels {
  std::vector<WheelSample> wheels;
  Side kept = Side::left;  ///< the side whose times they have: that with fewer samples
  std::size_t alone = 0;   ///< samples of it that have none of the other wheel near
};

/// @param left, right sorted by time, each time once
JoinedWheels joined_wheels(std::vector<SideSample> left, std::vector<SideSample> right, Between between);

}  // namespace odomcalib
