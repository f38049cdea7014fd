#include "daemon/service/write_gate.hpp"

#include <fmt/format.h>

#include <cmath>

#include "daemon/service/settings.hpp"

namespace odomcalib {

Error axes_not_off(const Bench& bench) {
  return {ErrorCode::device, "controller is " + name_of(bench.drive.controller().state()), "write-back",
          "values are written only to a controller that answers and whose axes are off"};
}

bool comes_to_rest(const Bench& bench) {
  const auto state = bench.drive.controller().state();
  return state == drivers::ControllerState::enabled || state == drivers::ControllerState::enabling;
}

std::optional<Error> write_forbidden(const Bench& bench) {
  const auto state = bench.drive.controller().state();
  if (bench.write_back.busy())
    return Error{ErrorCode::busy, "another write-back is running", "", "wait for its end"};
  if (bench.write_back.proving())
    return Error{ErrorCode::busy, "other values wait for their proof", "write-back",
                 "wait for its end, or take them back: odomcalibctl rollback"};
  if (state != drivers::ControllerState::disabled && !comes_to_rest(bench)) return axes_not_off(bench);
  return bench.drive.unread();
}

std::optional<Error> implausible(const ParameterMap& values, const ParameterMap& present) {
  for (const auto& [name, value] : values) {
    const auto known = present.find(name);
    if (known == present.end())
      return Error{ErrorCode::usage, "unknown parameter \"" + name + "\"", "", "odomcalibctl params get"};
    const bool plausible =
        std::isfinite(value) && std::abs(value / known->second - 1.0) <= service::settings::kPlausibleLength;
    if (!plausible)
      return Error{ErrorCode::refused,
                   fmt::format("{} = {} m is more than 15 % from {} m", name, value, known->second),
                   "write-back", "check the nominal values"};
  }
  return std::nullopt;
}

ParameterMap present_lengths(const RobotDescription& robot) {
  return {{"left_wheel_diameter", robot.left_wheel_diameter},
          {"right_wheel_diameter", robot.right_wheel_diameter},
          {"track_width", robot.track_width}};
}

}  // namespace odomcalib
