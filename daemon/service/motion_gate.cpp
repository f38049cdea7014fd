#include "daemon/service/motion_gate.hpp"

#include <fmt/format.h>

#include "daemon/service/settings.hpp"

namespace odomcalib {
namespace {

Error forbidden(ErrorCode code, const std::string& what, const std::string& remedy) {
  return {code, what, "motion", remedy};
}

std::optional<Error> controller_forbids(const Drive& drive) {
  using drivers::ControllerState;
  const drivers::Controller& controller = drive.controller();
  const auto state = controller.state();
  // A drive in fault that is configured may be started again: enabling it by hand resets the fault.
  const bool faulty = state == ControllerState::fault && controller.watchdog_armed();
  if (state != ControllerState::disabled && state != ControllerState::enabled && !faulty)
    return forbidden(ErrorCode::device,
                     "controller is " + name_of(state) + (drive.trouble.empty() ? "" : ": " + drive.trouble),
                     "see odomcalibctl check");
  if (!controller.watchdog_armed())
    return forbidden(ErrorCode::device, "the controller would not stop by itself if this program died",
                     "use a profile with a watchdog (heartbeat consumer or communication-loss time)");
  return std::nullopt;
}

}  // namespace

std::optional<Error> too_long(const routines::Plan& plan) {
  double duration = 0.0;
  for (const auto& move : plan.moves) duration += routines::expected_duration(move, plan.limits);
  if (duration <= service::settings::kLongestPlan_s) return std::nullopt;
  return forbidden(ErrorCode::usage,
                   fmt::format("this would take {:.0f} minutes, 30 are allowed", duration / 60.0),
                   "less distance, fewer turns or repetitions, or faster");
}

std::optional<Error> motion_forbidden(const RobotParts& parts, const routines::Preview& preview) {
  if (parts.write_back.operator_needed)
    return forbidden(ErrorCode::write_unknown,
                     "an interrupted write-back has left the controller's values unknown",
                     "connect the controller and restart odomcalibd, then see odomcalibctl params get");
  if (parts.write_back.going_back())
    return forbidden(ErrorCode::busy, "values that were not proven are taken back first", "wait for its end");
  if (auto wrong = controller_forbids(parts.drive)) return wrong;
  if (const auto stale = parts.drive.encoders.stale(parts.now))
    return forbidden(ErrorCode::device, *stale, "see odomcalibctl check");
  if (const auto stale = parts.surroundings.scans.stale(parts.now))
    return forbidden(ErrorCode::device, *stale, "see odomcalibctl check");
  if (auto why = parts.drive.unread()) return why;
  if (const auto way = safety::occupied(parts.surroundings.points, preview, parts.config.footprint,
                                        parts.config.clearance))
    return forbidden(ErrorCode::refused, *way, "clear the area, or move the robot");
  return std::nullopt;
}

}  // namespace odomcalib
