#include "tests/sim/wires/fault_commands.hpp"

#include <functional>
#include <map>
#include <sstream>

namespace odomcalib::sim {

namespace {

using Action = std::function<Result<void>(SimRobot&)>;

template <typename Work>
Action simply(Work work) {
  return [work](SimRobot& robot) -> Result<void> {
    work(robot);
    return {};
  };
}

const std::map<std::string, Action>& fixed_commands() {
  static const std::map<std::string, Action> commands{
      {"cut can", simply([](SimRobot& r) { r.cut_can(true); })},
      {"restore can", simply([](SimRobot& r) { r.cut_can(false); })},
      {"cut lidar", simply([](SimRobot& r) { r.lidar_faults().cut = true; })},
      {"restore lidar", simply([](SimRobot& r) { r.lidar_faults().cut = false; })},
      {"unplug can", simply([](SimRobot& r) { r.unplug_can(); })},
      {"plug can", [](SimRobot& r) { return r.plug_can(); }},
      {"unplug lidar", simply([](SimRobot& r) { r.unplug_lidar(); })},
      {"plug lidar", [](SimRobot& r) { return r.plug_lidar(); }},
      {"freeze pdo", simply([](SimRobot& r) { r.node().faults.pdo_frozen = true; })},
      {"thaw pdo", simply([](SimRobot& r) { r.node().faults.pdo_frozen = false; })},
      {"freeze lidar", simply([](SimRobot& r) { r.lidar_faults().frozen = true; })},
      {"thaw lidar", simply([](SimRobot& r) { r.lidar_faults().frozen = false; })},
      {"silence heartbeat", simply([](SimRobot& r) { r.node().faults.heartbeat_stopped = true; })},
      {"speak heartbeat", simply([](SimRobot& r) { r.node().faults.heartbeat_stopped = false; })},
      {"silence sdo", simply([](SimRobot& r) { r.node().sdo_faults().silent = true; })},
      {"speak sdo", simply([](SimRobot& r) { r.node().sdo_faults().silent = false; })},
      {"silence pdo", simply([](SimRobot& r) { r.node().faults.pdo_silent = true; })},
      {"speak pdo", simply([](SimRobot& r) { r.node().faults.pdo_silent = false; })},
      {"reset drive", simply([](SimRobot& r) { r.reset_drive(); })},
      {"reset lidar", simply([](SimRobot& r) { r.reset_lidar(); })},
      {"hold left", simply([](SimRobot& r) { r.hold_encoder(kLeft, true); })},
      {"hold right", simply([](SimRobot& r) { r.hold_encoder(kRight, true); })},
      {"release left", simply([](SimRobot& r) { r.hold_encoder(kLeft, false); })},
      {"release right", simply([](SimRobot& r) { r.hold_encoder(kRight, false); })},
      {"swap counts", simply([](SimRobot& r) { r.node().faults.swap_sides ^= true; })},
      {"swap motors", simply([](SimRobot& r) { r.node().faults.swap_motors ^= true; })},
      {"invert left motor", simply([](SimRobot& r) { r.node().faults.motor_inverted[kLeft] ^= true; })},
      {"invert right motor", simply([](SimRobot& r) { r.node().faults.motor_inverted[kRight] ^= true; })},
      {"invert left counts", simply([](SimRobot& r) { r.scale_encoder(kLeft, -1.0); })},
      {"invert right counts", simply([](SimRobot& r) { r.scale_encoder(kRight, -1.0); })},
      {"mirror lidar", simply([](SimRobot& r) { r.lidar_faults().mirrored ^= true; })},
      {"clear", simply([](SimRobot& r) { r.node().sdo_faults().abort_on_write.clear(); })},
  };
  return commands;
}

/// Commands with numbers. @return false when it is none of them
bool apply_with_numbers(SimRobot& robot, const std::string& line) {
  std::istringstream words(line);
  std::string verb;
  words >> verb;
  if (verb == "emcy") {
    unsigned code = 0;
    if (!(words >> std::hex >> code) || code > 0xFFFF) return false;
    robot.emergency(static_cast<std::uint16_t>(code));
    return true;
  }
  if (verb == "abort") {
    unsigned index = 0, sub = 0, code = 0;
    if (!(words >> std::hex >> index >> sub >> code) || index > 0xFFFF || sub > 0xFF) return false;
    const ObjectKey key{static_cast<std::uint16_t>(index), static_cast<std::uint8_t>(sub)};
    robot.node().sdo_faults().abort_on_write[key] = code;
    return true;
  }
  if (verb == "jump") {
    std::int64_t left = 0, right = 0;
    if (!(words >> left >> right)) return false;
    robot.shift_counts(left, right);
    return true;
  }
  Vec2 place;
  if (verb != "obstacle" || !(words >> place.x >> place.y)) return false;
  robot.room().add_pillar(place, 0.1);
  return true;
}

}  // namespace

Result<void> apply_command(SimRobot& robot, const std::string& line) {
  const auto found = fixed_commands().find(line);
  if (found != fixed_commands().end()) return found->second(robot);
  if (apply_with_numbers(robot, line)) return {};
  return Error{ErrorCode::usage, "unknown command: " + line, "stdin", "see tests/sim/README.md"};
}

}  // namespace odomcalib::sim
