// A robot's nominal geometry as TOML (odomcalib-robot.toml(5)): a file of its own, or the daemon's
// configuration.
#pragma once

#include <filesystem>
#include <string>

#include "proto/measurements.hpp"
#include "proto/result.hpp"

namespace odomcalib {

/// Missing keys stay zero or absent. In a file with a section [robot] the keys are looked for there, and the
/// lidar's pose in [lidar] too; the other sections of odomcalib.toml are left alone. Errors: io, format (key,
/// what is allowed, or which key was probably meant), empty (no key at all).
Result<RobotDescription> read_robot_file(const std::filesystem::path& path);
Result<RobotDescription> parse_robot_file(const std::string& text, const std::string& where);

/// `base` with every value that `over` states.
RobotDescription overlaid(RobotDescription base, const RobotDescription& over);

}  // namespace odomcalib
