#include "daemon/config/robot_file.hpp"

#include <array>
#include <cmath>

#include "daemon/config/settings.hpp"
#include "daemon/config/toml_reader.hpp"

namespace odomcalib {
namespace {

namespace settings = config::settings;

constexpr const char* kRobotManual = "odomcalib-robot.toml(5)";

struct Translation {
  const char* foreign;  ///< key of other programs and data sheets
  const char* instead;
};

constexpr std::array kTranslations = {
    Translation{"wheel_radius", "wheel_diameter, which is twice the radius, in m"},
    Translation{"left_wheel_radius", "left_wheel_diameter, which is twice the radius, in m"},
    Translation{"right_wheel_radius", "right_wheel_diameter, which is twice the radius, in m"},
    Translation{"diameter", "wheel_diameter, in m"},
    Translation{"wheelbase", "track_width: the distance between the two driven wheels, in m"},
    Translation{"wheel_base", "track_width: the distance between the two driven wheels, in m"},
    Translation{"wheel_separation", "track_width, in m"},
    Translation{"axle_length", "track_width, in m"},
    Translation{"axle_track", "track_width, in m"},
    Translation{"encoder_resolution", "ticks_per_rev: counts for one turn of a wheel, gear included"},
    Translation{"ticks_per_revolution", "ticks_per_rev: counts for one turn of a wheel, gear included"},
    Translation{"counts_per_rev", "ticks_per_rev: counts for one turn of a wheel, gear included"},
    Translation{"cpr", "ticks_per_rev: counts for one turn of a wheel, gear included"},
    Translation{"ppr",
                "ticks_per_rev: counts for one turn of a wheel, gear included; four for a pulse of a "
                "quadrature encoder"},
    Translation{"lidar_x", "lidar_pose = [x, y, yaw], in m and rad"},
    Translation{"lidar_y", "lidar_pose = [x, y, yaw], in m and rad"},
    Translation{"lidar_yaw", "lidar_pose = [x, y, yaw], in m and rad"},
    Translation{"laser_pose", "lidar_pose = [x, y, yaw], in m and rad"},
};

// Keys of odomcalib.toml beside the robot's geometry.
constexpr std::array kOtherKeys = {"controller.", "lidar.",      "limits.",    "lcm.",
                                   "daemon.",     "robot.front", "robot.back", "robot.width"};

/// @param prefix "robot." in a file with that section, otherwise nothing
RobotDescription read_keys(TomlReader& toml, const std::string& prefix) {
  RobotDescription robot;
  const double both = toml.number(prefix + "wheel_diameter", 0.0, settings::kLength_m);
  robot.left_wheel_diameter = toml.number(prefix + "left_wheel_diameter", both, settings::kLength_m);
  robot.right_wheel_diameter = toml.number(prefix + "right_wheel_diameter", both, settings::kLength_m);
  robot.track_width = toml.number(prefix + "track_width", 0.0, settings::kLength_m);
  robot.ticks_per_rev = toml.number(prefix + "ticks_per_rev", 0.0, settings::kTicks);
  robot.lidar_pose = toml.pose(prefix + "lidar_pose");
  robot.robot_id = toml.text(prefix + "robot_id", "");
  for (const auto& [foreign, instead] : kTranslations) toml.translate(prefix + foreign, instead);
  return robot;
}

RobotDescription read_section(TomlReader& toml) {
  RobotDescription robot = read_keys(toml, "robot.");
  if (const auto pose = toml.pose("lidar.pose")) robot.lidar_pose = pose;
  robot.robot_id = toml.text("robot.id", robot.robot_id);
  for (const char* key : kOtherKeys) toml.leave(key);
  return robot;
}

bool states_nothing(const RobotDescription& robot) {
  return robot.left_wheel_diameter == 0.0 && robot.right_wheel_diameter == 0.0 && robot.track_width == 0.0 &&
         robot.ticks_per_rev == 0.0 && !robot.lidar_pose && robot.robot_id.empty();
}

Result<RobotDescription> robot_from(Result<TomlReader> document, const std::string& where) {
  if (!document) return document.error();
  TomlReader& toml = document.value();
  const RobotDescription robot = toml.has_table("robot") ? read_section(toml) : read_keys(toml, "");
  if (const auto problem = toml.problem()) return *problem;
  if (states_nothing(robot))
    return Error{
        ErrorCode::empty, "states nothing about the robot", where,
        std::string("write wheel_diameter, track_width, ticks_per_rev or lidar_pose; see ") + kRobotManual};
  return robot;
}

}  // namespace

Result<RobotDescription> read_robot_file(const std::filesystem::path& path) {
  return robot_from(TomlReader::read(path, kRobotManual), path.string());
}

Result<RobotDescription> parse_robot_file(const std::string& text, const std::string& where) {
  return robot_from(TomlReader::parse(text, where, kRobotManual), where);
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
