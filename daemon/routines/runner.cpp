#include "daemon/routines/runner.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "daemon/routines/settings.hpp"

namespace odomcalib::routines {
namespace {

bool usable(const Pose& pose, double now) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.yaw) && std::isfinite(now);
}

void begin_move(const Plan& plan, RunState& state, const Pose& pose, double now) {
  const Move& move = plan.moves[state.move];
  const Move resolved = move.heading ? spin(wrapped(*move.heading - pose.yaw), move.pace) : move;
  state.direction = resolved.direction;
  state.amount = resolved.amount;
  state.start = pose;
  state.turned = 0.0;
  state.last_yaw = pose.yaw;
  state.pace = state.commanded = 0.0;
  state.last_time = now;
  state.since = now;
  state.phase = Phase::moving;
}

double progress(const RunState& state, const Pose& pose) {
  if (state.direction.w != 0.0) return state.turned * state.direction.w;
  const double along = std::cos(state.start.yaw) * (pose.x - state.start.x) +
                       std::sin(state.start.yaw) * (pose.y - state.start.y);
  return along * state.direction.v;
}

double wanted_pace(const Move& move, const Profile& profile, double done, double amount) {
  const double remaining = amount - done;
  const bool late = move.late_pace > 0.0 && done > 0.5 * amount;
  const double cruise = std::min(late ? move.late_pace : move.pace, profile.fastest);
  const double braking =
      std::sqrt(2.0 * settings::kBrakingShare * profile.acceleration * std::max(0.0, remaining));
  return std::min(cruise, std::max(braking, settings::kCreepShare * profile.acceleration));
}

void settle(RunState& state, double now) {
  state.phase = Phase::settling;
  state.pace = 0.0;
  state.since = now;
}

Twist drive(const Plan& plan, RunState& state, const Pose& pose, double now) {
  const Move& move = plan.moves[state.move];
  state.turned += wrapped(pose.yaw - state.last_yaw);
  state.last_yaw = pose.yaw;
  const double dt = std::clamp(now - state.last_time, 0.0, settings::kLongestStep_s);
  state.last_time = now;
  state.commanded += state.pace * dt;
  const double done = move.open_loop ? state.commanded : progress(state, pose);
  // The command issued now acts for about one step: stop where that step would pass the goal by half of it.
  if (state.amount - done <= 0.5 * state.pace * std::max(dt, settings::kShortestStep_s)) {
    settle(state, now);
    return {};
  }
  Move resolved = move;
  resolved.direction = state.direction;
  const Profile profile = profile_of(resolved, plan.limits);
  const double wanted = wanted_pace(resolved, profile, done, state.amount);
  const double change = profile.acceleration * dt;
  state.pace = std::clamp(wanted, state.pace - change, state.pace + change);
  return {state.direction.v * state.pace, state.direction.w * state.pace};
}

void leave_settled(const Plan& plan, RunState& state, double now) {
  if (now - state.since < plan.moves[state.move].settle) return;
  ++state.move;
  state.phase = state.move < plan.moves.size() ? Phase::beginning : Phase::done;
}

}  // namespace

Profile profile_of(const Move& move, const Limits& limits) {
  const Limits caps = capped(limits);
  const double v = std::abs(move.direction.v);
  const double w = std::abs(move.direction.w);
  Profile profile{std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
  if (v > 0.0) profile = {caps.speed / v, caps.acceleration / v};
  if (w > 0.0)
    profile = {std::min(profile.fastest, caps.turn_rate / w),
               std::min(profile.acceleration, caps.turn_acceleration / w)};
  profile.acceleration *= std::clamp(move.haste, settings::kLeastHaste, 1.0);
  return profile;
}

std::vector<std::string> limited(const Plan& plan) {
  std::vector<std::string> found;
  for (const Move& move : plan.moves) {
    const double wanted = std::max(move.pace, move.late_pace),
                 fastest = profile_of(move, plan.limits).fastest;
    if (wanted <= fastest) continue;
    const char* const unit = move.direction.w != 0.0 || move.heading ? "rad/s" : "m/s";
    const auto text =
        fmt::format("{}: {:.2f} {} instead of {:.2f}, the limit", move.name, fastest, unit, wanted);
    if (std::find(found.begin(), found.end(), text) == found.end()) found.push_back(text);
  }
  return found;
}

Step next_step(const Plan& plan, RunState state, const Pose& pose, double now) {
  if (plan.moves.empty()) state.phase = Phase::done;
  if (state.phase == Phase::done || !usable(pose, now)) return {{}, state};
  if (state.phase == Phase::beginning) begin_move(plan, state, pose, now);
  Twist twist;
  if (state.phase == Phase::moving)
    twist = drive(plan, state, pose, now);
  else
    leave_settled(plan, state, now);
  return {twist, state};
}

Twist Runner::step(double now, const Pose& pose) {
  const Step taken = next_step(plan_, state_, pose, now);
  state_ = taken.state;
  return taken.twist;
}

}  // namespace odomcalib::routines
