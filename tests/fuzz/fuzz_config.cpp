// Text as the daemon's configuration and as a robot file: whatever it says, the answer is values within their
// bounds or an error that says what and where.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <toml++/toml.h>

#include "daemon/config/config.hpp"
#include "daemon/config/robot_file.hpp"
#include "tests/fuzz/share.hpp"

namespace {

using namespace odomcalib;
using fuzz::require;

constexpr const char* kFile = "fuzz.toml";

void check(const Error& error) {
  require(error.code == ErrorCode::format || error.code == ErrorCode::empty);
  require(!error.what.empty() && error.where.starts_with(kFile) && !error.remedy.empty());
}

bool is_length(double value) { return value == 0.0 || (value >= 1e-3 && value <= 10.0); }
bool is_within(double value, double cap) { return value > 0.0 && value <= cap; }

void check(const RobotDescription& robot) {
  require(is_length(robot.left_wheel_diameter) && is_length(robot.right_wheel_diameter) &&
          is_length(robot.track_width));
  require(robot.ticks_per_rev >= 0.0 && robot.ticks_per_rev <= 1e9);
  if (robot.lidar_pose)
    for (const double number : *robot.lidar_pose) require(std::isfinite(number));
}

void check(const Config& config) {
  check(config.robot);
  for (const double number : config.lidar_pose) require(std::isfinite(number));
  const auto& caps = routines::kCaps;
  require(is_within(config.limits.speed, caps.speed) && is_within(config.limits.turn_rate, caps.turn_rate) &&
          is_within(config.limits.acceleration, caps.acceleration) &&
          is_within(config.limits.turn_acceleration, caps.turn_acceleration));
  for (const double side : {config.area_length, config.area_width}) require(is_within(side, 20.0));
  require(is_within(config.clearance, 2.0) && config.countdown >= 1.0 && config.countdown <= 60.0);
  for (const double length : {config.footprint.front, config.footprint.back, config.footprint.half_width})
    require(is_within(length, 5.0));
  require(config.keep_recordings >= 1'000'000);
}

/// No value goes unread and unnoticed: a key in quotes only looks like one of ours. @return values in it
std::size_t check_keys(const toml::table& table) {
  std::size_t values = 0;
  for (const auto& [key, node] : table) {
    const auto* inner = node.as_table();
    const std::size_t below = inner != nullptr ? check_keys(*inner) : 1;
    require(below == 0 || (!key.str().empty() && key.str().find('.') == std::string_view::npos));
    values += below;
  }
  return values;
}

/// The two read the same robot out of one file.
void compare(const RobotDescription& ours, const Result<RobotDescription>& theirs) {
  const bool states_some = ours.left_wheel_diameter > 0.0 || ours.right_wheel_diameter > 0.0 ||
                           ours.track_width > 0.0 || !ours.robot_id.empty();
  if (!states_some) return;
  require(theirs.ok());
  const RobotDescription all = overlaid(ours, theirs.value());
  require(all.left_wheel_diameter == ours.left_wheel_diameter &&
          all.right_wheel_diameter == ours.right_wheel_diameter && all.track_width == ours.track_width &&
          all.robot_id == ours.robot_id);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto config = parse_config(text, kFile);
  const auto robot = parse_robot_file(text, kFile);
  if (!config) check(config.error());
  if (!robot) check(robot.error());
  if (robot) check(robot.value());
  if (!config) return 0;
  check(config.value());
  compare(config.value().robot, robot);
  (void)check_keys(toml::parse(text));
  return 0;
}
