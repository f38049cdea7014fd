// Rule M10: the space that a motion requires, as a map with what the lidar sees in it, and in numbers.
#pragma once

#include <string>
#include <vector>

#include "daemon/routines/motion.hpp"
#include "daemon/safety/obstacle.hpp"

namespace odomcalib::safety {

/// One side of the robot: 0 ahead, 1 left, 2 behind, 3 right. All in m from the middle of the axle.
struct SideSpace {
  double needed = 0.0;            ///< how far the required space reaches
  std::optional<double> nearest;  ///< the nearest reading in the lane that the robot and its clearance take
};

struct ClearSpace {
  /// Cells from ahead to behind, each row from left to right: 'R' the robot now, '.' required by the motion,
  /// '#' a reading of the lidar, ' ' anything else.
  std::vector<std::string> rows;
  double cell = 0.0;  ///< m, edge of a cell
  std::array<SideSpace, 4> sides;
};

/// @param points readings in the base frame @param clearance m around the robot, anywhere on its way
ClearSpace clear_space(const std::vector<Point>& points, const routines::Preview& preview,
                       const Footprint& footprint, double clearance);

}  // namespace odomcalib::safety
