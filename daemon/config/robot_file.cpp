#include "daemon/config/robot_file.hpp"

#include <cmath>

#include "daemon/config/toml_reader.hpp"

namespace odomcalib {

Result<RobotDescription> read_robot_file(const std::filesystem::path& path) {
  auto document = TomlReader::read(path);
  if (!document) return document.error();
  TomlReader& toml = document.value();
  RobotDescription robot;
  const double both = toml.number("wheel_diameter", 0.0, 1e-3, 10.0);
  robot.left_wheel_diameter = toml.number("left_wheel_diameter", both, 1e-3, 10.0);
  robot.right_wheel_diameter = toml.number("right_wheel_diameter", both, 1e-3, 10.0);
  robot.track_width = toml.number("track_width", 0.0, 1e-3, 10.0);
  robot.ticks_per_rev = toml.number("ticks_per_rev", 0.0, 1e-3, 1e9);
  robot.lidar_pose = toml.pose("lidar_pose");
  robot.robot_id = toml.text("robot_id", "");
  if (const auto problem = toml.problem()) return *problem;
  return robot;
}

RobotDescription overlaid(RobotDescription base, const RobotDescription& over) {
  if (over.left_wheel_diameter > 0.0) base.left_wheel_diameter = over.left_wheel_diameter;
  if (over.right_wheel_diameter > 0.0) base.right_wheel_diameter = over.right_wheel_diameter;
  if (over.track_width > 0.0) base.track_width = over.track_width;
  if (over.ticks_per_rev > 0.0) base.ticks_per_rev = over.ticks_per_rev;
  if (over.lidar_pose) base.lidar_pose = over.lidar_pose;
  if (!over.robot_id.empty()) base.robot_id = over.robot_id;
  return base;
}

}  // namespace odomcalib
