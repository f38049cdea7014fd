#include "daemon/service/status_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "daemon/safety/obstacle.hpp"
#include "daemon/service/settings.hpp"
#include "odomcalib_version.hpp"
#include "proto/base_quantities.hpp"

namespace odomcalib {
namespace {

ordered_json check(const std::string& name, bool good, const std::string& found, const std::string& remedy) {
  return check_row(name, good ? "ok" : "fail", found, good ? "" : remedy);
}

/// A blind area of the lidar is no failure: it is to be looked at by somebody.
ordered_json view_check(const std::vector<safety::Sector>& blind) {
  if (blind.empty()) return check("lidar view", true, "all around", "");
  return check_row("lidar view", "warn", "blind from " + safety::text_of(blind) + " (0 is ahead, 90 left)",
                   "moves that go there need somebody who vouches for them: see that this area is free");
}

/// Later edits count from the next start on: a robot that moves is not configured anew.
std::optional<ordered_json> config_check(const Config& config) {
  if (config.file.empty()) return std::nullopt;
  std::error_code error;
  const auto written = std::filesystem::last_write_time(config.file, error);
  if (!error && written == config.written)
    return check("configuration", true, "as the daemon has read it", "");
  return check_row("configuration", "warn",
                   config.file.string() + (error ? ": " + error.message() : " was edited since the start"),
                   "systemctl restart odomcalib");
}

/// Refusals of the controller are stated here too, not in the journal alone.
ordered_json controller_check(const Drive& drive) {
  using drivers::ControllerState;
  const auto state = drive.controller().state();
  const bool good = state == ControllerState::disabled || state == ControllerState::enabled;
  const char* const remedy = drive.trouble.empty()
                                 ? "switch the controller on; check the profile's node id and the bit rate"
                                 : "correct the profile, or the controller";
  return check("controller", good,
               name_of(state) + (good || drive.trouble.empty() ? "" : ": " + drive.trouble), remedy);
}

/// A slow watchdog limits the speed (rule M1).
std::string watchdog_text(double time) {
  const double fastest = safety::fastest_with(time);
  const std::string stops = fmt::format("controller stops by itself after {:.2g} s", time);
  return fastest < routines::kCaps.speed
             ? stops + fmt::format("; that limits the speed to {:.2f} m/s", fastest)
             : stops;
}

ordered_json watchdog_check(const drivers::Controller& controller) {
  using drivers::ControllerState;
  const auto state = controller.state();
  if (state == ControllerState::absent || state == ControllerState::configuring)
    return check("watchdog", false, "not known: the controller is " + name_of(state), "see its line");
  const double time = controller.watchdog_time();
  return check("watchdog", time > 0.0,
               time > 0.0 ? watchdog_text(time) : "controller would not stop by itself",
               "use a profile with a watchdog");
}

ordered_json check_disk(const std::filesystem::path& folder, const StateFolder& state) {
  if (const auto& why = state.read_only()) return check("disk", false, why->what, why->remedy);
  constexpr std::uintmax_t kMegabyte = 1'000'000;
  std::error_code error;
  const auto space = std::filesystem::space(folder, error);
  if (error) return check("disk", false, error.message(), "see that " + folder.string() + " is there");
  const std::uintmax_t left = space.available / kMegabyte;
  const bool enough = left >= service::settings::kLeastSpace_MB;
  return check("disk", enough, enough ? "enough space" : "only " + std::to_string(left) + " MB left",
               "remove old recordings");
}

/// No failure: on a machine that does nothing else the loop is in time all the same.
ordered_json scheduling_check(const Urgency& urgency) {
  return check_row("scheduling", urgency.remedy.empty() ? "ok" : "warn", urgency.found, urgency.remedy);
}

ordered_json json_of(const LoopWatch::Longest& turn) {
  return {{"seconds", turn.seconds}, {"part", turn.part}};
}

std::string text_of(const std::optional<Error>& problem) { return problem ? problem->text() : ""; }

std::string found_at(bool connected, const std::optional<Error>& problem) {
  if (problem) return problem->text();
  return connected ? "open" : "not open yet";
}

/// Address that the name of a lidar's host stands for, so that a wrong one is seen.
std::string by_name(const LidarLink& link) {
  const std::string name = link.host_name();
  if (name.empty() || link.found_address().empty()) return "";
  return ", " + name + " is " + link.found_address();
}

// Values that a controller cannot hold stay on the host, one by one.
void add_host_values(const std::vector<HostValue>& values, ordered_json& list) {
  for (const HostValue& value : values)
    list.push_back({{"name", value.name},
                    {"unit", value.quantity.unit},
                    {"value", nullptr},
                    {"calibrated", value.quantity.value},
                    {"stored_in", "host"},
                    {"applied_in", value.applied_in}});
}

ordered_json controller_report(const Drive& drive, double now) {
  const drivers::Controller& controller = drive.controller();
  ordered_json body = {{"device", drive.link.device()},
                       {"connected", drive.link.connected()},
                       {"state", name_of(controller.state())},
                       {"problem", text_of(drive.link.problem())},
                       {"watchdog_armed", controller.watchdog_armed()},
                       {"ticks", drive.tick_count},
                       {"stale", drive.encoders.stale(now).value_or("")},
                       {"counters", drive.link.counters()},
                       {"supply_voltage", nullptr}};
  if (const auto voltage = controller.supply_voltage()) body["supply_voltage"] = *voltage;
  for (const auto& one : controller.capabilities())
    body["holds"][one.quantity] = {{"readable", one.readable},
                                   {"writable", one.writable},
                                   {"stored", one.stored},
                                   {"object", one.object},
                                   {"step", one.step}};
  if (const auto id = controller.identity())
    body["identity"] = {{"vendor", id->vendor},
                        {"product", id->product},
                        {"revision", id->revision},
                        {"serial", id->serial},
                        {"name", id->name}};
  return body;
}

ordered_json lidar_report(const Surroundings& surroundings, double now) {
  const LidarLink& lidar = surroundings.link;
  return {{"device", lidar.device()},         {"identity", lidar.identity()},
          {"connected", lidar.connected()},   {"problem", text_of(lidar.problem())},
          {"scans", surroundings.scan_count}, {"stale", surroundings.scans.stale(now).value_or("")},
          {"counters", lidar.counters()}};
}

/// A controller that took the place of another: what it holds is not what was verified. Empty: it is no
/// other.
std::string replaced_text(const Drive& drive, const WriteBack& write_back) {
  const std::string ours = device_of(drive.controller());
  const auto former = write_back.of_former_controller(ours);
  if (!former) return "";
  return fmt::format(
      "this controller (\"{}\") is another than that of the newest write-back, entry {} (\"{}\")", ours,
      former->id, former->device);
}

/// No failure: the robot goes by what the controller holds, as far as that is likely.
std::optional<ordered_json> replaced_check(const Drive& drive, const WriteBack& write_back) {
  const std::string found = replaced_text(drive, write_back);
  if (found.empty()) return std::nullopt;
  const auto former = write_back.of_former_controller(device_of(drive.controller()));
  return check_row("replaced", "warn", found,
                   "the last verified values: odomcalibctl rollback --to " + former->id + " --replaced");
}

/// A length in the controller; null: the host alone has it.
const drivers::StoredParameter* held_in(const Drive& drive, BaseQuantity length) {
  const auto found = std::find_if(drive.in_force.begin(), drive.in_force.end(),
                                  [&](const auto& p) { return is_name_of(p.quantity, length); });
  return found == drive.in_force.end() ? nullptr : &*found;
}

/// Rounding leaves less than a step of the controller (round_together).
bool is_rounding(double remainder, double step) { return std::abs(remainder) <= step; }

bool is_writable(const Drive& drive, BaseQuantity length) {
  const auto all = drive.controller().capabilities();
  return std::any_of(all.begin(), all.end(),
                     [&](const auto& one) { return is_name_of(one.quantity, length) && one.writable; });
}

/// Lengths of the calibration in force that the controller could hold and does not. Empty: there is none, or
/// a write-back is about to change that.
std::string unheld_text(const RobotParts& parts) {
  const auto& calibration = parts.applied.get();
  if (!calibration || parts.write_back.busy() || parts.write_back.proving()) return "";
  std::string text;
  for (const BaseQuantity length : kDriveLengths) {
    const auto calibrated = calibration->parameter(length);
    const auto* held = held_in(parts.drive, length);
    if (!calibrated || held == nullptr || is_rounding(*calibrated - held->value, held->step)) continue;
    if (!is_writable(parts.drive, length)) continue;
    text += text.empty() ? "the controller does not hold the calibration in force: " : "; ";
    text += fmt::format("{} = {:.6g} m, not {:.6g} m", name_of(length), held->value, *calibrated);
  }
  return text;
}

/// No failure: the host makes corrected odometry from the calibration all the same.
std::optional<ordered_json> unheld_check(const RobotParts& parts) {
  const std::string found = unheld_text(parts);
  if (found.empty()) return std::nullopt;
  return check_row("calibration", "warn", found,
                   "write it again: odomcalibctl apply FILE; or take it back: odomcalibctl rollback");
}

ordered_json robot_report(const Drive& drive) {
  const RobotDescription all = drive.robot();
  ordered_json body;
  for (const BaseQuantity length : kDriveLengths) body[name_of(length)] = all.*member_of(length);
  body["ticks_per_rev"] = all.ticks_per_rev;
  body["in_controller"] = !drive.in_force.empty();
  body["robot_id"] = all.robot_id;
  return body;
}

ordered_json motion_report(const MotionCount& recorded) {
  return {{"straight", {{"stretches", recorded.straight().stretches}, {"m", recorded.straight().amount}}},
          {"left", {{"stretches", recorded.left().stretches}, {"rad", recorded.left().amount}}},
          {"right", {{"stretches", recorded.right().stretches}, {"rad", recorded.right().amount}}},
          {"missing", recorded.missing()}};
}

ordered_json client_report(const ControlServer& server) {
  return {{"connected", server.clients()},
          {"not_permitted", server.counters().not_permitted},
          {"malformed", server.counters().malformed},
          {"too_many", server.counters().too_many}};
}

ordered_json lcm_report(const Publisher::Counters& counters) {
  return {{"sent", counters.sent}, {"failed", counters.failed}, {"dropped", counters.dropped}};
}

ordered_json loop_report(const Urgency& urgency, const LoopWatch& loop) {
  return {{"scheduling", urgency.found},
          {"turns", loop.turns()},
          {"late_steps", loop.late_steps()},
          {"longest_turn", json_of(loop.since_start())},
          {"longest_turn_in_motion", json_of(loop.in_motion())}};
}

}  // namespace

ordered_json check_row(const std::string& name, const std::string& outcome, const std::string& found,
                       const std::string& remedy) {
  return {{"name", name}, {"outcome", outcome}, {"found", found}, {"remedy", remedy}};
}

std::string activity(const RobotParts& parts, const Task* task) {
  if (parts.ending) return parts.write_back.busy() ? "ending: reading or writing parameters" : "ending";
  if (task != nullptr) return task->activity();
  return parts.write_back.busy() ? "reading or writing parameters" : "idle";
}

std::string one_line(const RobotParts& parts, const Task* task) {
  std::string line = activity(parts, task);
  const auto missing = [&line](const char* what, const std::string& why) {
    line += std::string("; no ") + what + (why.empty() ? "" : ": " + why);
  };
  const auto state = parts.drive.controller().state();
  const BaseLink& base = parts.drive.link;
  if (!base.connected())
    missing("bus", text_of(base.problem()));
  else if (state == drivers::ControllerState::absent)
    missing("controller", parts.drive.trouble);
  const LidarLink& lidar = parts.surroundings.link;
  if (!lidar.connected() || parts.surroundings.scans.stale(parts.now))
    missing("scans", text_of(lidar.problem()));
  if (parts.write_back.proving()) line += "; new values wait for their proof";
  return line;
}

ordered_json status_report(const RobotParts& parts, const Task* task) {
  const Telemetry& telemetry = parts.outbox.telemetry;
  const auto& pose = parts.odometry.pose();
  ordered_json body;
  body["format"] = "odomcalib-status/1";
  body["state"] = activity(parts, task);
  body["version"] = kVersion;
  body["controller"] = controller_report(parts.drive, parts.now);
  body["lidar"] = lidar_report(parts.surroundings, parts.now);
  body["robot"] = robot_report(parts.drive);
  body["obstacle"] = parts.surroundings.obstacles.obstacle().value_or("");
  body["progress"] = task == nullptr ? ordered_json() : parts.outbox.last_progress();
  body["odometry"] = {pose.x, pose.y, routines::wrapped(pose.yaw)};
  body["calibrated"] = parts.applied.get().has_value();
  const auto proven = parts.write_back.proven();
  body["calibration_not_held"] = unheld_text(parts);
  body["proven"] = proven ? ordered_json(*proven) : ordered_json(nullptr);
  body["replaced_controller"] = replaced_text(parts.drive, parts.write_back);
  body["operator_needed"] = parts.write_back.operator_needed;
  body["last_stop"] = parts.last_run.last_stop();
  body["lcm"] = lcm_report(telemetry.publisher.counters());
  body["clients"] = client_report(parts.outbox.server);
  body["loop"] = loop_report(parts.urgency, parts.loop);
  body["recording_bytes"] = telemetry.recorder.bytes();
  body["recording_bytes_waiting"] = telemetry.recorder.bytes_waiting();
  body["recorded_motion"] = motion_report(parts.recorded);
  return body;
}

ordered_json scan_report(const Surroundings& surroundings, double now) {
  const auto& points = surroundings.points;
  ordered_json list = ordered_json::array();
  const std::size_t step = points.size() / service::settings::kMostScanPoints + 1;
  const auto rounded = [](double metres) { return std::round(1000.0 * metres) / 1000.0; };
  if (!surroundings.scans.stale(now))
    for (std::size_t k = 0; k < points.size(); k += step)
      list.push_back({rounded(points[k].x), rounded(points[k].y)});
  return {{"points", list}};
}

ordered_json description(const Config& config) {
  return {
      {"version", kVersion},
      {"controller", {{"device", config.controller_device}, {"profile", config.controller_profile}}},
      {"lidar", {{"device", config.lidar_device}, {"type", config.lidar_type}, {"pose", config.lidar_pose}}},
      {"limits",
       {{"speed", config.limits.speed},
        {"turn_rate", config.limits.turn_rate},
        {"acceleration", config.limits.acceleration},
        {"area", {config.area_length, config.area_width}},
        {"countdown", config.countdown}}},
      {"lcm", {{"url", config.lcm_enabled ? config.lcm_url : ""}, {"channel_prefix", config.channel_prefix}}},
      {"state_dir", config.state_dir.string()}};
}

ordered_json check_report(const RobotParts& parts) {
  const Drive& drive = parts.drive;
  const Surroundings& around = parts.surroundings;
  const WriteBack& write_back = parts.write_back;
  const RobotDescription all = drive.robot();
  ordered_json list = ordered_json::array();
  list.push_back(check("bus", drive.link.connected(), found_at(drive.link.connected(), drive.link.problem()),
                       "connect the adapter; check controller.device"));
  list.push_back(controller_check(drive));
  list.push_back(watchdog_check(drive.controller()));
  list.push_back(check("encoders", !drive.encoders.stale(parts.now),
                       drive.encoders.stale(parts.now).value_or("counts arrive"), "check the bus"));
  list.push_back(check("lidar port", around.link.connected(),
                       found_at(around.link.connected(), around.link.problem()) + by_name(around.link),
                       "connect it; check lidar.device"));
  list.push_back(check("scans", !around.scans.stale(parts.now),
                       around.scans.stale(parts.now).value_or("scans arrive"), "check lidar and baud rate"));
  list.push_back(view_check(around.cover.blind(parts.now).sectors()));
  const auto wrong = drive.geometry_forbidden();
  const bool ticks_known = all.ticks_per_rev > 0.0;
  list.push_back(wrong ? check("geometry", false, wrong->what, wrong->remedy)
                       : check("geometry", ticks_known,
                               !ticks_known             ? "not known: ticks per turn"
                               : drive.in_force.empty() ? "from the configuration"
                                                        : "from the controller",
                               "state the ticks per turn in the profile"));
  list.push_back(
      check("write-back", !write_back.operator_needed,
            write_back.operator_needed ? write_back.problem : "nothing unfinished",
            "odomcalibctl rollback, or apply a calibration; or connect the controller and restart"));
  if (auto replaced = replaced_check(drive, write_back)) list.push_back(*replaced);
  if (auto unheld = unheld_check(parts)) list.push_back(*unheld);
  list.push_back(check_disk(parts.config.state_dir, parts.folder));
  if (!parts.urgency.found.empty()) list.push_back(scheduling_check(parts.urgency));
  if (auto configuration = config_check(parts.config)) list.push_back(*configuration);
  return list;
}

ordered_json parameter_report(const Drive& drive, const Calibrator& calibrator,
                              const std::optional<Calibration>& calibration, const ParameterMap& to_be) {
  const RobotDescription all = drive.robot();
  ordered_json list = ordered_json::array();
  for (const BaseQuantity length : kDriveLengths) {
    const double value = all.*member_of(length);
    const auto* held = held_in(drive, length);
    ordered_json entry = {{"name", name_of(length)},
                          {"unit", row_of(length).unit},
                          {"value", nullptr},
                          {"calibrated", nullptr}};
    if (value > 0.0) entry["value"] = value;
    const char* place = held != nullptr ? "controller, rounding remainder in corrected odometry"
                                        : "corrected odometry on the host";
    if (const auto calibrated = calibration ? calibration->parameter(length) : std::nullopt) {
      entry["calibrated"] = *calibrated;
      const auto written = to_be.find(name_of(length));
      const double remainder = *calibrated - (written == to_be.end() ? value : written->second);
      if (held != nullptr && !is_rounding(remainder, held->step))
        place = "corrected odometry on the host; the controller holds another value";
      else
        entry["remainder"] = remainder;
    }
    entry["stored_in"] = held != nullptr ? "controller" : "host";
    entry["applied_in"] = place;
    list.push_back(entry);
  }
  if (calibration && calibrator.host_values) add_host_values(calibrator.host_values(*calibration), list);
  return list;
}

}  // namespace odomcalib
