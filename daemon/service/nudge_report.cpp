// Findings on the wiring from a nudge of each wheel.

#include <fmt/format.h>

#include "daemon/routines/wiring.hpp"
#include "daemon/service/dead_reckoning.hpp"
#include "daemon/service/leg_report.hpp"
#include "daemon/service/status_report.hpp"
#include "proto/angles.hpp"

namespace odomcalib {
namespace {

/// Motion of the lidar in its own axes: as if it sat in the middle of the base.
std::optional<routines::Pose> seen_by(const Calibrator& calibrator, const Leg& leg) {
  if (!calibrator.match || !leg.scan_before || !leg.scan_after) return std::nullopt;
  return calibrator.match(*leg.scan_before, *leg.scan_after, {}, {});
}

/// The same motion seen from its end.
routines::Pose undone(const routines::Pose& pose) { return relative(pose, {}); }

routines::Pose mean(const routines::Pose& a, const routines::Pose& b) {
  return {0.5 * (a.x + b.x), 0.5 * (a.y + b.y), 0.5 * (a.yaw + b.yaw)};
}

/// One move and its opposite.
routines::NudgeMove nudge_move(const Calibrator& calibrator, const RobotDescription& robot, const Leg& there,
                               const Leg& back) {
  const routines::Twist amount{there.move.direction.v * there.move.amount,
                               there.move.direction.w * there.move.amount};
  const auto wheels =
      routines::to_wheels(amount, {robot.left_wheel_diameter, robot.right_wheel_diameter, robot.track_width});
  routines::NudgeMove out;
  out.commanded = {wheels.left, wheels.right};
  const auto ahead = wheel_turns(there, robot.ticks_per_rev), behind = wheel_turns(back, robot.ticks_per_rev);
  for (std::size_t i = 0; i < 2; ++i) out.counted.at(i) = 0.5 * (ahead.at(i) - behind.at(i));
  const auto first = seen_by(calibrator, there), second = seen_by(calibrator, back);
  if (first && second) out.seen = mean(*first, undone(*second));
  return out;
}

routines::Nudge nudge_of(const Calibrator& calibrator, const RobotDescription& robot,
                         const std::vector<Leg>& legs) {
  routines::Nudge nudge;
  nudge.wheel_radius = 0.25 * (robot.left_wheel_diameter + robot.right_wheel_diameter);
  nudge.track_width = robot.track_width;
  nudge.lidar_yaw = robot.lidar_pose ? (*robot.lidar_pose)[2] : 0.0;
  nudge.ahead = nudge_move(calibrator, robot, legs.at(0), legs.at(1));
  nudge.left = nudge_move(calibrator, robot, legs.at(2), legs.at(3));
  return nudge;
}

ordered_json json_of(const routines::NudgeMove& move) {
  ordered_json body = {{"commanded", move.commanded}, {"counted", move.counted}, {"lidar", nullptr}};
  if (move.seen) body["lidar"] = {move.seen->x, move.seen->y, move.seen->yaw};
  return body;
}

ordered_json json_of(const std::vector<routines::WiringFault>& faults) {
  ordered_json list = ordered_json::array();
  for (const auto& fault : faults)
    list.push_back({{"name", fault.name}, {"what", fault.what}, {"remedy", fault.remedy}});
  return list;
}

std::string name_of(routines::Wiring::Outcome outcome) {
  if (outcome == routines::Wiring::Outcome::good) return "ok";
  return outcome == routines::Wiring::Outcome::wrong ? "fail" : "warn";
}

ordered_json json_of(const routines::Nudge& nudge, const routines::Wiring& wiring) {
  ordered_json body = {{"outcome", name_of(wiring.outcome)},    {"why", wiring.why},
                       {"explanations", ordered_json::array()}, {"lidar_yaw", nullptr},
                       {"ahead", json_of(nudge.ahead)},         {"left", json_of(nudge.left)}};
  for (const auto& one : wiring.explanations) body["explanations"].push_back(json_of(one));
  if (wiring.lidar_yaw) body["lidar_yaw"] = *wiring.lidar_yaw;
  return body;
}

/// Rows like those of the other checks. Alternatives follow each other.
void add_rows(const routines::Wiring& wiring, ordered_json& checks) {
  using Outcome = routines::Wiring::Outcome;
  const auto add = [&](const std::string& found, const std::string& remedy) {
    checks.push_back(check_row("wiring", name_of(wiring.outcome), found, remedy));
  };
  if (wiring.outcome == Outcome::unclear)
    add(wiring.why, "see that the wheels turn freely and walls are in sight");
  if (wiring.outcome == Outcome::good)
    add(fmt::format("sides and signs as configured, lidar yaw about {:.0f} deg",
                    kDegrees * wiring.lidar_yaw.value_or(0.0)),
        "");
  for (std::size_t i = 0; i < wiring.explanations.size(); ++i)
    for (const auto& fault : wiring.explanations[i]) add((i == 0 ? "" : "or: ") + fault.what, fault.remedy);
}

}  // namespace

ordered_json nudge_report(ordered_json checks, const Calibrator& calibrator, const RobotDescription& robot,
                          const std::vector<Leg>& legs) {
  if (legs.size() != 4) return {{"checks", checks}, {"wiring", nullptr}};
  const auto nudge = nudge_of(calibrator, robot, legs);
  const auto wiring = routines::judge_wiring(nudge);
  add_rows(wiring, checks);
  return {{"checks", checks}, {"wiring", json_of(nudge, wiring)}};
}

}  // namespace odomcalib
