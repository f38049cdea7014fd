// The robot as it really is, which nobody on the other end of the wires can see, and as its papers say it is.
#pragma once

#include <cstdint>

#include "tests/sim/world/geometry.hpp"

namespace odomcalib::sim {

/// Lengths in m; the lidar pose is given in the base frame (middle of the axle).
struct Geometry {
  double left_diameter = 0.150;
  double right_diameter = 0.150;
  double track_width = 0.400;
  Pose lidar{0.100, 0.0, 0.0};
  double ticks_per_rev = 16384.0;  ///< counts per wheel turn
};

/// A robot whose dimensions differ from the nominal ones: diameters and track by 1 to 3 %, the wheels from
/// each other by up to 1 %, the lidar by up to 20 mm and 3 degrees. Same seed, same robot.
Geometry draw_truth(const Geometry& nominal, std::uint64_t seed);

}  // namespace odomcalib::sim
