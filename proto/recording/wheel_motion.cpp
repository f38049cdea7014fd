#include "proto/recording/wheel_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace odomcalib {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kMostCounts = 9007199254740992.0;  // 2^53: beyond it a count is no exact double
// Tolerance, in counts. Angles that an encoder made deviate from its grid by the rounding of a double (1e-4
// counts after a million turns of 4096 counts) or of a text with six decimals (1e-3 counts); of angles from
// elsewhere every second one deviates by more than a quarter.
constexpr double kOnGrid = 0.05;

/// Both angles never leave one turn: only then can a driver have cut off whole turns.
bool within_one_turn(const std::vector<WheelSample>& wheels) {
  constexpr double kRounding = 1e-5;  // rad, of single precision
  const auto inside = [&](double low) {
    return std::all_of(wheels.begin(), wheels.end(), [&](const WheelSample& sample) {
      return std::min(sample.left, sample.right) >= low - kRounding &&
             std::max(sample.left, sample.right) <= low + kTurn + kRounding;
    });
  };
  return inside(0.0) || inside(-std::numbers::pi);
}

std::vector<WheelSample> continued(std::vector<WheelSample> wheels) {
  if (!within_one_turn(wheels)) return wheels;
  for (std::size_t i = 1; i < wheels.size(); ++i) {
    wheels[i].left = wheels[i - 1].left + std::remainder(wheels[i].left - wheels[i - 1].left, kTurn);
    wheels[i].right = wheels[i - 1].right + std::remainder(wheels[i].right - wheels[i - 1].right, kTurn);
  }
  return wheels;
}

bool on_grid(double change, double counts_per_rev) {
  const double counts = change / kTurn * counts_per_rev;
  return std::abs(counts) < kMostCounts && std::abs(counts - std::round(counts)) <= kOnGrid;
}

bool all_on_grid(const std::vector<WheelSample>& wheels, double counts_per_rev) {
  return std::all_of(wheels.begin(), wheels.end(), [&](const WheelSample& sample) {
    return on_grid(sample.left - wheels.front().left, counts_per_rev) &&
           on_grid(sample.right - wheels.front().right, counts_per_rev);
  });
}

bool at_origin(const PoseSample& pose) { return pose.x == 0.0 && pose.y == 0.0 && pose.yaw == 0.0; }

}  // namespace

bool is_reset(const PoseSample& before, const PoseSample& pose) {
  return at_origin(pose) && !at_origin(before);
}

std::int64_t count_of(double angle, double counts_per_rev) {
  const double counts = angle / kTurn * counts_per_rev;
  return std::abs(counts) < kMostCounts ? std::llround(counts) : 0;
}

MadeTicks ticks_from_wheels(const std::vector<WheelSample>& wheels, double stated) {
  const std::vector<WheelSample> whole = continued(wheels);
  MadeTicks made;
  if (stated > 0.0 && all_on_grid(whole, stated)) made.ticks_per_rev = stated;
  for (const WheelSample& sample : whole) {
    // The grid of an encoder need not go through zero: what was counted are the differences.
    const WheelSample& first = whole.front();
    made.ticks.push_back(
        {sample.t,
         count_of(first.left, made.ticks_per_rev) + count_of(sample.left - first.left, made.ticks_per_rev),
         count_of(first.right, made.ticks_per_rev) + count_of(sample.right - first.right, made.ticks_per_rev),
         0});
  }
  return made;
}

MadeTicks ticks_from_wheel_speeds(const std::vector<WheelSample>& speeds) {
  MadeTicks made;
  double left = 0.0, right = 0.0;  // rad
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    if (i > 0) {
      const double held = speeds[i].t - speeds[i - 1].t;
      left += held * speeds[i - 1].left;
      right += held * speeds[i - 1].right;
    }
    made.ticks.push_back(
        {speeds[i].t, count_of(left, made.ticks_per_rev), count_of(right, made.ticks_per_rev), 0});
  }
  return made;
}

std::array<double, 2> wheel_ways(const std::array<double, 3>& from, const std::array<double, 3>& to,
                                 double track_width) {
  const double turn = std::remainder(to[2] - from[2], kTurn);
  const double heading = from[2] + turn / 2.0;
  const double chord = std::cos(heading) * (to[0] - from[0]) + std::sin(heading) * (to[1] - from[1]);
  const double arc = turn == 0.0 ? chord : chord * (turn / 2.0) / std::sin(turn / 2.0);
  return {arc - turn * track_width / 2.0, arc + turn * track_width / 2.0};
}

MadeTicks ticks_from_odometry(const std::vector<PoseSample>& poses, const RobotDescription& robot) {
  MadeTicks made;
  double left = 0.0, right = 0.0;  // m
  std::int32_t segment = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const PoseSample& to = poses[i];
    if (i > 0 && is_reset(poses[i - 1], to)) {
      ++segment;
    } else if (i > 0) {
      const PoseSample& from = poses[i - 1];
      const auto ways = wheel_ways({from.x, from.y, from.yaw}, {to.x, to.y, to.yaw}, robot.track_width);
      left += ways[0];
      right += ways[1];
    }
    made.ticks.push_back({to.t, count_of(2.0 * left / robot.left_wheel_diameter, made.ticks_per_rev),
                          count_of(2.0 * right / robot.right_wheel_diameter, made.ticks_per_rev), segment});
  }
  return made;
}

}  // namespace odomcalib
