#include "daemon/service/parts/drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/service/settings.hpp"
#include "daemon/writeback/transaction.hpp"
#include "proto/base_quantities.hpp"

namespace odomcalib {
namespace {

Error write_forbidden(ErrorCode code, const std::string& what, const std::string& remedy) {
  return {code, what, "motion", remedy};
}

}  // namespace

std::string name_of(drivers::ControllerState state) {
  constexpr std::array kNames = {"absent", "configuring", "disabled", "enabling", "enabled", "fault"};
  return kNames.at(static_cast<std::size_t>(state));
}

Drive::News Drive::serve(const Clock& clock, double now) {
  link.step(clock);
  News news{controller().take_ticks(), controller().take_events(), std::nullopt,
            watch_.look(link.device(), link.connected(), link.problem())};
  for (const TickSample& sample : news.ticks) encoders.seen(sample, now);
  if (!news.ticks.empty()) newest_ticks = news.ticks.back();
  tick_count += news.ticks.size();
  if (controller().touched()) values_known = false;
  const auto state = controller().state();
  if (state != state_) news.state = state;
  state_ = state;
  note_trouble(news);
  return news;
}

void Drive::note_trouble(const News& news) {
  const bool configured =
      state_ != drivers::ControllerState::absent && state_ != drivers::ControllerState::configuring;
  if (configured) return trouble.clear();
  for (const drivers::ControllerEvent& event : news.events)
    if (event.stop) trouble = event.text;
}

bool Drive::off() const {
  const auto state = controller().state();
  return !link.connected() ||
         (state != drivers::ControllerState::enabled && state != drivers::ControllerState::enabling);
}

RobotDescription Drive::nominal() const {
  RobotDescription all = controller().description();
  const RobotDescription& given = config_.robot;
  if (given.left_wheel_diameter > 0.0) all.left_wheel_diameter = given.left_wheel_diameter;
  if (given.right_wheel_diameter > 0.0) all.right_wheel_diameter = given.right_wheel_diameter;
  if (given.track_width > 0.0) all.track_width = given.track_width;
  all.lidar_pose = config_.lidar_pose;
  if (!given.robot_id.empty()) all.robot_id = given.robot_id;
  return all;
}

RobotDescription Drive::robot() const {
  RobotDescription all = nominal();
  for (const auto& parameter : in_force)
    if (const auto length = base_quantity_from(parameter.quantity); length && is_drive_length(*length))
      all.*member_of(*length) = parameter.value;
  return all;
}

RobotDescription Drive::described() const {
  RobotDescription all = robot();
  all.controller_id = device_of(controller());
  return all;
}

routines::WheelGeometry Drive::geometry() const {
  const RobotDescription all = robot();
  return {all.left_wheel_diameter, all.right_wheel_diameter, all.track_width};
}

std::optional<Error> Drive::unread() const {
  const auto held = controller().capabilities();
  const bool readable = std::any_of(held.begin(), held.end(), [](const auto& one) { return one.readable; });
  if (values_known || !readable) return std::nullopt;
  if (controller().touched())
    return Error{ErrorCode::device, "another program changed the controller, which was not read again yet",
                 "controller", "end the other program, and wait two seconds"};
  return Error{ErrorCode::device, "the controller's values were not read yet", "controller",
               "wait two seconds; if it stays, check the bus"};
}

bool Drive::take(const std::vector<drivers::StoredParameter>& found, const ParameterMap& written) {
  if (const std::string device = device_of(controller()); device != device_) {
    forget_values();
    device_ = device;
  }
  const auto before = changed_.size();
  for (const drivers::StoredParameter& one : found) compare(one, written.contains(one.quantity));
  return changed_.size() > before;
}

void Drive::compare(const drivers::StoredParameter& found, bool written) {
  const auto same = [&](const drivers::StoredParameter& one) { return one.quantity == found.quantity; };
  std::erase_if(in_force, same);
  in_force.push_back(found);
  if (written) expected_[found.quantity] = found;
  const auto& expected = expected_.try_emplace(found.quantity, found).first->second;
  changed_.erase(found.quantity);
  if (expected.raw != found.raw) changed_[found.quantity] = {expected, found};
}

void Drive::forget_values() {
  in_force.clear();
  expected_.clear();
  changed_.clear();
}

std::optional<Error> Drive::changed_besides(const ParameterMap& values) const {
  const auto besides = std::find_if(changed_.begin(), changed_.end(),
                                    [&](const auto& one) { return !values.contains(one.first); });
  if (besides == changed_.end()) return std::nullopt;
  const auto& [name, change] = *besides;
  const auto held = controller().capabilities();
  const auto where = std::find_if(held.begin(), held.end(),
                                  [&, quantity = name](const auto& one) { return one.quantity == quantity; });
  return Error{
      ErrorCode::refused,
      fmt::format("the controller holds {} = {:.6g} m, not {:.6g} m as before: another program wrote "
                  "it, or it restarted",
                  name, change.found.value, change.expected.value),
      where == held.end() ? "controller" : "controller, object " + where->object,
      fmt::format("odomcalibctl params set {}={:.6g} puts it back, {}={:.6g} keeps it; or apply a "
                  "calibration",
                  name, change.expected.value, name, change.found.value)};
}

// Speeds are wheel rates times diameters: with wrong diameters the cap of M7 is none. What the controller
// holds goes before the configuration, so it has to be known and likely.
std::optional<Error> Drive::geometry_forbidden() const {
  if (auto why = unread()) return why;
  if (auto changed = changed_besides({})) return changed;
  const RobotDescription expected = nominal(), all = robot();
  if (!(all.left_wheel_diameter > 0.0 && all.right_wheel_diameter > 0.0 && all.track_width > 0.0))
    return write_forbidden(ErrorCode::missing_units, "wheel diameters or track width are not known",
                           "state robot.wheel_diameter and robot.track_width in the configuration");
  for (const BaseQuantity length : kDriveLengths) {
    const double value = all.*member_of(length), wanted = expected.*member_of(length);
    if (wanted > 0.0 && std::abs(value / wanted - 1.0) > service::settings::kPlausibleLength)
      return write_forbidden(
          ErrorCode::refused,
          fmt::format("the controller holds {} = {:.4f} m, the configuration says {:.4f} m", name_of(length),
                      value, wanted),
          "measure the robot; correct robot.* in the configuration or the profile, or the "
          "controller's value");
  }
  return std::nullopt;
}

}  // namespace odomcalib
