// The daemon's configuration file (TOML, /etc/odomcalib/odomcalib.toml; keys: odomcalib.toml(5)).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "daemon/routines/motion.hpp"
#include "daemon/safety/obstacle.hpp"
#include "proto/measurements.hpp"
#include "proto/result.hpp"

namespace odomcalib {

struct Config {
  /// Where it was read from and when that was written; empty: from elsewhere.
  std::filesystem::path file;
  std::filesystem::file_time_type written{};
  // [controller]
  std::string controller_device;   ///< "slcan:/dev/ttyACM0?bitrate=500000", "socketcan:can0"
  std::string controller_profile;  ///< profile file
  // [lidar]
  std::string lidar_device;  ///< "serial:/dev/ttyUSB0?baud=230400"
  std::string lidar_type = "ld06";
  std::array<double, 3> lidar_pose{};  ///< x, y [m], yaw [rad] in the base frame, nominal
  // [robot]: used where the controller's profile states nothing
  RobotDescription robot;
  safety::Footprint footprint;
  // [limits]
  routines::Limits limits;
  double area_length = 2.0, area_width = 2.0;  ///< m, free area around the start of a pattern
  double clearance = 0.30;                     ///< m, free beside the way before a motion begins
  double countdown = 3.0;                      ///< s before a motion
  // [lcm]
  bool lcm_enabled = true;
  std::string lcm_url = "udpm://239.255.76.67:7667?ttl=0";
  std::string channel_prefix = "ODOMCALIB_";
  // [daemon]
  std::filesystem::path state_dir = "/var/lib/odomcalib";
  std::uintmax_t keep_recordings = 4'000'000'000;  ///< bytes; beyond them the oldest are removed
  std::filesystem::path socket = "/run/odomcalib/control";
  std::string group = "odomcalib";
};

/// Errors: io, format (file, key, what is allowed).
Result<Config> read_config(const std::filesystem::path& path);
Result<Config> parse_config(const std::string& text, const std::string& where);

}  // namespace odomcalib
