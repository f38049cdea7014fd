#include "daemon/config/config.hpp"

#include <algorithm>

#include "daemon/config/settings.hpp"
#include "daemon/config/toml_reader.hpp"
#include "proto/file_bytes.hpp"

namespace odomcalib {
namespace {

namespace settings = config::settings;

constexpr const char* kManual = "odomcalib.toml(5)";

void read_devices(TomlReader& toml, Config& config) {
  config.controller_device = toml.text("controller.device", config.controller_device);
  config.controller_profile = toml.text("controller.profile", config.controller_profile);
  config.lidar_device = toml.text("lidar.device", config.lidar_device);
  config.lidar_type = toml.text("lidar.type", config.lidar_type);
  config.lidar_pose = toml.pose("lidar.pose").value_or(config.lidar_pose);
}

void read_robot(TomlReader& toml, Config& config) {
  RobotDescription& robot = config.robot;
  robot.robot_id = toml.text("robot.id", "");
  const double both = toml.number("robot.wheel_diameter", 0.0, settings::kLength_m);
  robot.left_wheel_diameter = toml.number("robot.left_wheel_diameter", both, settings::kLength_m);
  robot.right_wheel_diameter = toml.number("robot.right_wheel_diameter", both, settings::kLength_m);
  robot.track_width = toml.number("robot.track_width", 0.0, settings::kLength_m);
  config.footprint.front = toml.number("robot.front", config.footprint.front, settings::kReach_m);
  config.footprint.back = toml.number("robot.back", config.footprint.back, settings::kReach_m);
  config.footprint.half_width =
      0.5 * toml.number("robot.width", 2.0 * config.footprint.half_width, settings::kWidth_m);
}

void read_limits(TomlReader& toml, Config& config) {
  const auto& caps = routines::kCaps;
  config.limits.speed = toml.number("limits.speed", caps.speed, {settings::kLeastSpeed_m_s, caps.speed});
  config.limits.turn_rate =
      toml.number("limits.turn_rate", caps.turn_rate, {settings::kLeastRate_rad_s, caps.turn_rate});
  config.limits.acceleration = toml.number("limits.acceleration", caps.acceleration,
                                           {settings::kLeastBraking_m_s2, caps.acceleration});
  config.limits.turn_acceleration = toml.number("limits.turn_acceleration", caps.turn_acceleration,
                                                {settings::kLeastTurning_rad_s2, caps.turn_acceleration});
  config.area_length = toml.number("limits.area_length", config.area_length, settings::kArea_m);
  config.area_width = toml.number("limits.area_width", config.area_width, settings::kArea_m);
  config.clearance = toml.number("limits.clearance", config.clearance, settings::kClearance_m);
  config.countdown = std::max(settings::kShortestCountdown_s,
                              toml.number("limits.countdown", config.countdown, settings::kCountdown_s));
}

void read_service(TomlReader& toml, Config& config) {
  config.lcm_enabled = toml.flag("lcm.enabled", config.lcm_enabled);
  config.lcm_url = toml.text("lcm.url", config.lcm_url);
  config.channel_prefix = toml.text("lcm.channel_prefix", config.channel_prefix);
  config.state_dir = toml.text("daemon.state_dir", config.state_dir.string());
  constexpr double kMegabyte = 1e6;
  config.keep_recordings = static_cast<std::uintmax_t>(
      kMegabyte * toml.number("daemon.keep_recordings",
                              static_cast<double>(config.keep_recordings) / kMegabyte,
                              settings::kRecordings_MB));
  config.socket = toml.text("daemon.socket", config.socket.string());
  config.group = toml.text("daemon.group", config.group);
}

Result<Config> config_from(Result<TomlReader> document) {
  if (!document) return document.error();
  Config config;
  read_devices(document.value(), config);
  read_robot(document.value(), config);
  read_limits(document.value(), config);
  read_service(document.value(), config);
  if (auto problem = document.value().problem()) return *problem;
  return config;
}

}  // namespace

Result<Config> read_config(const std::filesystem::path& path) {
  std::error_code ignored;  // shows in the reading
  const auto written = std::filesystem::last_write_time(path, ignored);
  auto config = config_from(TomlReader::read(path, kManual));
  if (!config) return config;
  config.value().file = path;
  config.value().written = written;
  return config;
}

Result<Config> parse_config(const std::string& text, const std::string& where) {
  return config_from(TomlReader::parse(text, where, kManual));
}

}  // namespace odomcalib
