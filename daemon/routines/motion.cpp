#include "daemon/routines/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "daemon/routines/runner.hpp"
#include "daemon/routines/settings.hpp"

namespace odomcalib::routines {
namespace {

double lower(double wanted, double cap) {
  return std::isfinite(wanted) && wanted > 0.0 ? std::min(wanted, cap) : cap;
}

double sign(double value) { return value < 0.0 ? -1.0 : 1.0; }

Pose advanced(const Pose& pose, const Twist& twist, double dt) {
  const double middle = pose.yaw + 0.5 * twist.w * dt;
  return {pose.x + twist.v * dt * std::cos(middle), pose.y + twist.v * dt * std::sin(middle),
          pose.yaw + twist.w * dt};
}

/// So long that the robot moves by half of what makes two poses, s.
double preview_step(const Twist& twist) {
  const double moved =
      std::max(std::abs(twist.v) / settings::kSamePlace_m, std::abs(twist.w) / settings::kSameHeading_rad);
  return std::clamp(0.5 / moved, settings::kShortestPreviewStep_s, settings::kLongestPreviewStep_s);
}

}  // namespace

Limits capped(const Limits& wanted) {
  return {lower(wanted.speed, kCaps.speed), lower(wanted.turn_rate, kCaps.turn_rate),
          lower(wanted.acceleration, kCaps.acceleration),
          lower(wanted.turn_acceleration, kCaps.turn_acceleration)};
}

WheelRates to_wheels(const Twist& twist, const WheelGeometry& geometry) {
  const bool usable =
      geometry.left_wheel_diameter > 0.0 && geometry.right_wheel_diameter > 0.0 && geometry.track_width > 0.0;
  if (!usable || !std::isfinite(twist.v) || !std::isfinite(twist.w)) return {};
  const double half = 0.5 * geometry.track_width * twist.w;
  return {2.0 * (twist.v - half) / geometry.left_wheel_diameter,
          2.0 * (twist.v + half) / geometry.right_wheel_diameter};
}

double wrapped(double angle) {
  return std::abs(angle) <= std::numbers::pi ? angle : std::remainder(angle, 2.0 * std::numbers::pi);
}

Move straight(double distance, double speed, double settle) {
  return {.name = distance < 0.0 ? "straight backward" : "straight forward",
          .direction = {sign(distance), 0.0},
          .amount = std::abs(distance),
          .pace = std::abs(speed),
          .settle = settle};
}

Move spin(double angle, double rate, double settle) {
  return {.name = angle < 0.0 ? "spin right" : "spin left",
          .direction = {0.0, sign(angle)},
          .amount = std::abs(angle),
          .pace = std::abs(rate),
          .settle = settle};
}

Move arc(double radius, double angle, double rate, bool forward, double settle) {
  return {.name = std::string(angle < 0.0 ? "right" : "left") + " arc " + (forward ? "forward" : "backward"),
          .direction = {forward ? radius : -radius, sign(angle)},
          .amount = std::abs(angle),
          .pace = std::abs(rate),
          .settle = settle};
}

Move turn_to(double heading, double rate) {
  return {.name = "turn to heading",
          .direction = {0.0, 1.0},
          .pace = rate,
          .settle = settings::kShortRest_s,
          .heading = heading};
}

double expected_duration(const Move& move, const Limits& limits) {
  Move turned = move;
  if (move.heading) turned = spin(std::numbers::pi, move.pace, move.settle);
  const Profile profile = profile_of(turned, limits);
  const double first = std::min(turned.pace, profile.fastest);
  const double slowest = turned.late_pace > 0.0 ? std::min(first, turned.late_pace) : first;
  if (slowest <= 0.0) return turned.settle;
  return turned.amount / slowest + 2.0 * first / profile.acceleration + turned.settle;
}

Preview preview(const Plan& plan) {
  Preview seen;
  Runner runner(plan);
  Pose pose;
  DistinctPoses distinct(settings::kSamePlace_m, settings::kSameHeading_rad);
  while (!runner.done() && seen.duration < settings::kLongestPreview_s) {
    distinct.add(pose);
    seen.reach = std::max(seen.reach, std::hypot(pose.x, pose.y));
    seen.heading = std::max(seen.heading, std::abs(pose.yaw));
    const Twist twist = runner.step(seen.duration, pose);
    const double step = preview_step(twist);
    pose = advanced(pose, twist, step);
    seen.duration += step;
  }
  seen.path = std::move(distinct).take();
  seen.end = pose;
  for (const Move& move : plan.moves) {
    if (move.direction.w == 0.0) seen.distance = std::max(seen.distance, move.amount);
    if (move.direction.w != 0.0) seen.turn = std::max(seen.turn, move.amount);
  }
  return seen;
}

void DistinctPoses::add(const Pose& pose) {
  const std::uint64_t cell = cell_of(pose);
  if (!poses_.empty() && cell == last_) return;
  last_ = cell;
  if (taken_.insert(cell).second) poses_.push_back(pose);
}

/// In one number: 24 bits for each coordinate are more than any robot drives, 16 for the heading than a turn
/// has.
std::uint64_t DistinctPoses::cell_of(const Pose& pose) const {
  const auto nearest = [](double value, double size) {
    return static_cast<std::uint64_t>(std::lround(value / size));
  };
  constexpr std::uint64_t kCoordinate = 0xFFFFFF, kHeading = 0xFFFF;
  return (nearest(pose.x, place_) & kCoordinate) << 40U | (nearest(pose.y, place_) & kCoordinate) << 16U |
         (nearest(wrapped(pose.yaw), heading_) & kHeading);
}

}  // namespace odomcalib::routines
