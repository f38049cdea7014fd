// Where a URDF or xacro file holds the place of the lidar on the base, and how it changes.
#pragma once

#include <string>
#include <vector>

#include "daemon/cli/text_edit.hpp"
#include "proto/result.hpp"

namespace odomcalib::cli {

/// On the base: x forward, y left, yaw counter-clockwise.
struct LidarPlace {
  double x = 0.0, y = 0.0, yaw = 0.0;  ///< m, m, rad
};

/// The place is the origin of the one fixed joint that holds the lidar on base_link or base_footprint. Its x,
/// y and yaw become the given ones; z, roll and pitch stay. Nothing to change: no edits.
/// @param link of the lidar; empty: the one whose name has laser, lidar or scan in it
/// @param where the file, for errors
/// Errors: format, with the lines, where there is not one such joint, it hangs on another link, the lidar
/// leans or is upside down, or a value is an expression of xacro.
Result<std::vector<TextEdit>> lidar_joint_edits(const std::string& urdf, const LidarPlace& lidar,
                                                const std::string& link, const std::string& where);

}  // namespace odomcalib::cli
