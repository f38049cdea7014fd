#include "daemon/service/write_gate.hpp"

#include <fmt/format.h>

#include <cmath>

#include "daemon/service/settings.hpp"
#include "proto/base_quantities.hpp"

namespace odomcalib {

Error axes_not_off(const Drive& drive) {
  return {ErrorCode::device, "controller is " + name_of(drive.controller().state()), "write-back",
          "values are written only to a controller that answers and whose axes are off"};
}

bool comes_to_rest(const Drive& drive) {
  const auto state = drive.controller().state();
  return state == drivers::ControllerState::enabled || state == drivers::ControllerState::enabling;
}

std::optional<Error> write_forbidden(const Drive& drive, const WriteBack& write_back) {
  const auto state = drive.controller().state();
  if (write_back.busy())
    return Error{ErrorCode::busy, "another write-back is running", "", "wait for its end"};
  if (write_back.proving())
    return Error{ErrorCode::busy, "other values wait for their proof", "write-back",
                 "wait for its end, or take them back: odomcalibctl rollback"};
  if (state != drivers::ControllerState::disabled && !comes_to_rest(drive)) return axes_not_off(drive);
  return drive.unread();
}

NominalLengths nominal_lengths(const Drive& drive, const Config& config) {
  const RobotDescription& given = config.robot;
  const std::string file = config.file.empty() ? "the configuration" : config.file.string();
  const std::string profile = "profile " + config.controller_profile;
  NominalLengths nominal{present_lengths(drive.nominal()), {}};
  for (const auto& [name, value] : present_lengths(given))
    nominal.from[name] = value > 0.0 ? fmt::format("robot.{} of {}", name, file) : profile;
  return nominal;
}

std::optional<Error> implausible(const ParameterMap& values, const NominalLengths& nominal) {
  for (const auto& [name, value] : values) {
    const auto known = nominal.values.find(name);
    if (known == nominal.values.end())
      return Error{ErrorCode::usage, "unknown parameter \"" + name + "\"", "", "odomcalibctl params get"};
    if (!(known->second > 0.0))
      return Error{ErrorCode::refused, name + " has no nominal value that it could be held to", "write-back",
                   "state robot." + name + " in the configuration, as it was built"};
    const bool plausible =
        std::isfinite(value) && std::abs(value / known->second - 1.0) <= service::settings::kPlausibleLength;
    if (!plausible)
      return Error{ErrorCode::refused,
                   fmt::format("{} = {:.6g} m is more than 15 % from the nominal {:.6g} m ({})", name, value,
                               known->second, nominal.from.at(name)),
                   "write-back", "check the nominal values; what was once committed: odomcalibctl rollback"};
  }
  return std::nullopt;
}

namespace {

Error absurd_member(const std::string& path, const std::string& why) {
  return {ErrorCode::refused, "\"" + path + "\" " + why, "calibration",
          "solve a recording of this robot again"};
}

std::optional<Error> absurd_quantity(const std::string& path, const Quantity& quantity, double most_std) {
  if (quantity.unit.empty()) return absurd_member(path + ".unit", "is missing");
  if (!std::isfinite(quantity.value)) return absurd_member(path + ".value", "is no finite number");
  if (!(quantity.std <= most_std))
    return absurd_member(path + ".std", fmt::format("is {}: with more than {:.3g} {} the value says nothing",
                                                    quantity.std, most_std, quantity.unit));
  return std::nullopt;
}

std::optional<Error> absurd_parameter_of_effect(const std::string& path, const Quantity& quantity) {
  constexpr double kMost = service::settings::kMostOfEffect;
  if (std::abs(quantity.value) > kMost)
    return absurd_member(path + ".value",
                         fmt::format("is {}: more than {} {}", quantity.value, kMost, quantity.unit));
  return absurd_quantity(path, quantity, kMost);
}

}  // namespace

std::optional<Error> absurd(const Calibration& calibration, const NominalLengths& nominal,
                            const UnitOfEffect& unit_of_effect) {
  namespace settings = service::settings;
  if (auto wrong = wrong_value(calibration, unit_of_effect, "calibration")) return wrong;
  for (const auto& [name, quantity] : calibration.parameters) {
    const auto length = nominal.values.find(name);
    const double known = length != nominal.values.end() ? length->second : 0.0;
    const double most_std = known > 0.0 ? settings::kPlausibleLength * known : settings::kMostLidarStd;
    if (auto wrong = absurd_quantity("parameters." + name, quantity, most_std)) return wrong;
  }
  for (const EffectResult& effect : calibration.effects)
    for (const auto& [name, quantity] : effect.parameters)
      if (auto wrong = absurd_parameter_of_effect("effects." + effect.name + ".parameters." + name, quantity))
        return wrong;
  return std::nullopt;
}

ParameterMap present_lengths(const RobotDescription& robot) {
  ParameterMap lengths;
  for (const BaseQuantity length : kDriveLengths) lengths[name_of(length)] = robot.*member_of(length);
  return lengths;
}

}  // namespace odomcalib
