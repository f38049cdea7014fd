#include "drivers/base/profile/profile.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

#include "drivers/base/profile/profile_reader.hpp"

namespace odomcalib::drivers {
namespace {

constexpr std::array kProtocols = {"canopen", "agilex", "arcos", "odrive", "ros_arduino", "segway", "vesc"};

void read_ticks(ProfileTable table, Profile& profile) {
  profile.ticks_per_rev = table.number("counts_per_rev", std::nullopt, 1.0, 1e9);
  if (profile.protocol != "canopen") {
    profile.count_source = table.text("source", "");
    profile.count_bits = static_cast<unsigned>(table.integer("bits", 32, 8, 32));
    profile.counts_live_s = 1e-3 * table.number("timeout_ms", 500.0, 50.0, 2000.0);
  }
  table.finish();
}

int read_sign(ProfileTable& table, std::string_view key) {
  const std::int64_t sign = table.integer(key, 1, -1, 1);
  if (sign == 0) table.complain(key, "0", "1, or -1 for a mirrored motor");
  return static_cast<int>(sign);
}

void read_speed(ProfileTable table, Profile& profile) {
  profile.max_rpm = table.number("max_rpm", std::nullopt, 0.1, 100'000.0);
  if (profile.protocol == "canopen") {
    profile.rpm_per_count = table.number("rpm_per_count", 1.0, 1e-6, 1000.0);
  } else {
    profile.motor_turns_per_rev = table.number("motor_turns_per_rev", 1.0, 1e-3, 1e4);
    profile.interval_s = 1e-3 * table.number("interval_ms", 0.0, 0.0, 1000.0);
  }
  table.finish();
}

void read_robot(ProfileTable table, Profile& profile) {
  profile.robot.left_wheel_diameter = table.number("left_wheel_diameter", 0.0, 0.0, 10.0);
  profile.robot.right_wheel_diameter = table.number("right_wheel_diameter", 0.0, 0.0, 10.0);
  profile.robot.track_width = table.number("track_width", 0.0, 0.0, 20.0);
  profile.robot.ticks_per_rev = profile.ticks_per_rev;
  profile.robot.controller = profile.name;
  table.finish();
}

void read_nodes(ProfileTable table, Profile& profile) {
  profile.left_node = static_cast<std::uint8_t>(table.integer("left", 1, 0, 255));
  profile.right_node = static_cast<std::uint8_t>(table.integer("right", 2, 0, 255));
  if (profile.left_node == profile.right_node)
    table.complain("right", "the same as left", "two different numbers");
  table.finish();
}

/// Devices with a command time-out of their own, which this program cannot set.
void read_builtin_watchdog(ProfileTable table, Profile& profile) {
  const std::string kind = table.text("kind", "none");
  if (kind != "builtin" && kind != "none")
    table.complain("kind", "\"" + kind + "\"", R"("builtin" or "none")");
  if (kind == "builtin") profile.watchdog.kind = ProfileWatchdog::Kind::builtin;
  profile.watchdog.time_ms = table.number("time_ms", 500.0, 20.0, 1e3 * kLongestWatchdog_s);
  table.finish();
}

void read_basics(ProfileTable& table, Profile& profile) {
  profile.name = table.text("name", std::nullopt);
  profile.protocol = table.text("protocol", std::nullopt);
  if (std::find(kProtocols.begin(), kProtocols.end(), profile.protocol) == kProtocols.end())
    table.complain("protocol", "\"" + profile.protocol + "\"",
                   "canopen, agilex, arcos, odrive, ros_arduino, segway, vesc");
  profile.bitrate = static_cast<unsigned>(table.integer("bitrate", 500'000, 9600, 1'000'000));
  profile.left_sign = read_sign(table, "left_sign");
  profile.right_sign = read_sign(table, "right_sign");
  read_ticks(table.table("ticks"), profile);
  read_speed(table.table("speed"), profile);
  read_robot(table.table("robot"), profile);
}

/// One drive of a pair: everything is its own but the name and the geometry.
Profile read_side(ProfileTable table, const std::string& side) {
  Profile profile;
  read_basics(table, profile);
  (void)table.text("style", "pair");
  read_nodes(table.table("nodes"), profile);
  const bool left = side == "left";
  profile.side = side;
  profile.axes = 1;
  profile.node = left ? profile.left_node : profile.right_node;
  if (profile.node < 1 || profile.node > 127) table.complain("nodes." + side, "no node id", "1 to 127");
  if (!left) profile.left_sign = profile.right_sign;
  read_canopen_tables(table, profile);
  table.finish();
  return profile;
}

void read_canopen(ProfileTable& table, Profile& profile) {
  profile.node = static_cast<std::uint8_t>(table.integer("node", 1, 1, 127));
  read_canopen_tables(table, profile);
  table.finish();
}

void read_others(ProfileTable& table, Profile& profile) {
  profile.node = static_cast<std::uint8_t>(table.integer("node", 0x7F, 0, 255));
  read_nodes(table.table("nodes"), profile);
  read_builtin_watchdog(table.table("watchdog"), profile);
  const RobotDescription& robot = profile.robot;
  const bool takes_twist = profile.protocol == "agilex" || profile.protocol == "arcos";
  if (takes_twist &&
      (robot.left_wheel_diameter <= 0.0 || robot.right_wheel_diameter <= 0.0 || robot.track_width <= 0.0))
    table.complain("robot", "a diameter or the track width is missing",
                   "all three: this controller takes speeds of the robot, not of its wheels");
  if (profile.protocol == "ros_arduino" && profile.interval_s <= 0.0)
    table.complain("speed.interval_ms", "it is missing", "the control interval of the firmware, e.g. 33.3");
  table.finish();
}

/// @param again makes a fresh view of the same table
template <typename Again>
Profile read_tables(ProfileTable& table, const Again& again) {
  Profile profile;
  read_basics(table, profile);
  if (profile.protocol != "canopen") {
    read_others(table, profile);
    return profile;
  }
  const std::string style = table.text("style", "dual-axis");
  if (style != "dual-axis" && style != "pair")
    table.complain("style", "\"" + style + "\"", "dual-axis, pair");
  if (style != "pair") {
    read_canopen(table, profile);
    return profile;
  }
  for (const char* side : {"left", "right"}) profile.sides.push_back(read_side(again(), side));
  profile.sync_period_s = profile.sides[0].sync_period_s;
  return profile;
}

}  // namespace

Result<Profile> parse_profile(const std::string& text, const std::string& where) {
  try {
    const toml::table root = toml::parse(text, where);
    ProfileProblem problem{where, std::nullopt};
    ProfileTable top(&root, "", problem);
    ProfileTable table = top.table("profile");
    if (!table.exists()) top.complain("profile", "it is missing", "a table [profile]");
    top.finish();
    Profile profile = read_tables(table, [&] { return top.table("profile"); });
    if (problem.first) return *problem.first;
    return profile;
  } catch (const toml::parse_error& error) {
    std::ostringstream place;
    place << where << ":" << error.source().begin.line << ":" << error.source().begin.column;
    return Error{ErrorCode::format, std::string(error.description()), place.str(),
                 "see docs/user/profiles.md"};
  }
}

Result<Profile> read_profile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf()))
    return Error{ErrorCode::io, "cannot read the controller profile", path, "check the path of the profile"};
  return parse_profile(text.str(), path);
}

}  // namespace odomcalib::drivers
