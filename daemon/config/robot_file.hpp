// A robot's nominal geometry as TOML: wheel_diameter or left_/right_wheel_diameter [m], track_width [m],
// ticks_per_rev, lidar_pose = [x m, y m, yaw rad], robot_id.
#pragma once

#include <filesystem>

#include "proto/measurements.hpp"
#include "proto/result.hpp"

namespace odomcalib {

/// Missing keys stay zero or absent. Errors: io, format (key, what was found, what is allowed).
Result<RobotDescription> read_robot_file(const std::filesystem::path& path);

/// `base` with every value that `over` states.
RobotDescription overlaid(RobotDescription base, const RobotDescription& over);

}  // namespace odomcalib
