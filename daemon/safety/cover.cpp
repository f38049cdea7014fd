#include "daemon/safety/cover.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "daemon/routines/runner.hpp"
#include "daemon/safety/settings.hpp"
#include "proto/angles.hpp"

namespace odomcalib::safety {
namespace {

using routines::Move;
using routines::Pose;
using routines::Twist;

constexpr double kTurn = 2.0 * std::numbers::pi;

// Readings below the least range of the sensor count too: its own mount is that near.
bool ends_on_robot(const Point& eye, double direction, double range, const Footprint& footprint) {
  if (!(range > 0.0)) return false;
  return inside({eye.x + range * std::cos(direction), eye.y + range * std::sin(direction)}, footprint, 0.0);
}

void add_edge(std::vector<Point>& out, const Point& from, const Point& to) {
  const auto steps =
      static_cast<int>(std::ceil(std::hypot(to.x - from.x, to.y - from.y) / settings::kEdgeStep_m));
  for (int i = 0; i < steps; ++i) {
    const double share = static_cast<double>(i) / steps;
    out.push_back({from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)});
  }
}

std::vector<Point> outline(const Footprint& footprint) {
  const std::array<Point, 4> corners{{{footprint.front, footprint.half_width},
                                      {-footprint.back, footprint.half_width},
                                      {-footprint.back, -footprint.half_width},
                                      {footprint.front, -footprint.half_width}}};
  std::vector<Point> out;
  for (std::size_t i = 0; i < corners.size(); ++i)
    add_edge(out, corners.at(i), corners.at((i + 1) % corners.size()));
  return out;
}

Point moved(const Pose& pose, const Point& point) {
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  return {pose.x + c * point.x - s * point.y, pose.y + s * point.x + c * point.y};
}

std::vector<Pose> turn_on_the_spot() {
  std::vector<Pose> out;
  for (int degrees = 0; degrees < 360; degrees += 5) out.push_back({0.0, 0.0, degrees / kDegrees});
  return out;
}

/// Twist of a move at its full pace.
Twist fastest_twist(const Move& move, const routines::Limits& limits) {
  const Twist direction = move.heading ? Twist{0.0, 1.0} : move.direction;
  Move resolved = move;
  resolved.direction = direction;
  const double pace = std::min(move.pace, routines::profile_of(resolved, limits).fastest);
  return {direction.v * pace, direction.w * pace};
}

bool goes_unseen(const Twist& twist, const BlindArea& blind, const ObstacleOptions& options) {
  const auto poses =
      is_spin(twist) ? turn_on_the_spot() : path_of(twist, stopping_distance(twist.v, options));
  const auto edge = outline(options.footprint);
  return std::any_of(poses.begin(), poses.end(), [&](const Pose& pose) {
    return std::any_of(edge.begin(), edge.end(), [&](const Point& point) {
      const Point there = moved(pose, point);
      return !inside(there, options.footprint, 1e-6) && blind.hides(there);
    });
  });
}

}  // namespace

std::string text_of(const std::vector<Sector>& sectors) {
  std::string out;
  for (const Sector& sector : sectors)
    out += fmt::format("{}{:.0f} to {:.0f} deg", out.empty() ? "" : ", ", sector.from * kDegrees,
                       sector.to * kDegrees);
  return out;
}

std::size_t BlindArea::bin_of(double direction) {
  const double turns = direction / kTurn - std::floor(direction / kTurn);
  return std::min(static_cast<std::size_t>(turns * kBins), kBins - 1);
}

bool BlindArea::hides(const Point& point) const {
  return blind_.at(bin_of(std::atan2(point.y - eye_.y, point.x - eye_.x)));
}

std::vector<Sector> BlindArea::sectors() const {
  constexpr double kBin = kTurn / kBins;
  // From a direction that is seen, so that no blind sector is cut in two.
  const auto first =
      static_cast<std::size_t>(std::find(blind_.begin(), blind_.end(), false) - blind_.begin());
  if (first == kBins) return {{0.0, kTurn}};
  std::vector<Sector> out;
  for (std::size_t i = first; i < first + kBins; ++i) {
    if (!blind_.at(i % kBins)) continue;
    const double from = static_cast<double>(i) * kBin;
    if (out.empty() || out.back().to < from - 0.5 * kBin) out.push_back({from, from});
    out.back().to = from + kBin;
  }
  for (Sector& sector : out)
    if (sector.from >= kTurn) sector = {sector.from - kTurn, sector.to - kTurn};
  return out;
}

Cover::Cover() {
  free_at_.fill(-std::numeric_limits<double>::infinity());
  robot_at_ = free_at_;
}

void Cover::seen(const Scan& scan, const std::array<double, 3>& lidar_pose, const Footprint& footprint,
                 double now) {
  eye_ = {lidar_pose[0], lidar_pose[1]};
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double direction = scan.angle(i) + lidar_pose[2];
    if (!std::isfinite(direction)) continue;
    if (ends_on_robot(eye_, direction, static_cast<double>(scan.ranges[i]), footprint))
      robot_at_.at(BlindArea::bin_of(direction)) = now;
    else
      for (const double beside : {-settings::kBeside_rad, 0.0, settings::kBeside_rad})
        free_at_.at(BlindArea::bin_of(direction + beside)) = now;
  }
}

BlindArea Cover::blind(double now) const {
  constexpr std::size_t kBins = BlindArea::kBins;
  const auto lately = [now](double when) { return now - when <= settings::kRemembered_s; };
  // A beam that lost its echo from the robot looks like one that met nothing: the robot counts.
  const auto dark = [&](std::size_t i) {
    return lately(robot_at_.at(i % kBins)) || !lately(free_at_.at(i % kBins));
  };
  BlindArea::Bins blind{};
  for (std::size_t begin = 0; begin < kBins; ++begin) {
    std::size_t run = 0;
    while (run < settings::kLeastBins && dark(begin + run)) ++run;
    for (std::size_t k = 0; run == settings::kLeastBins && k < run; ++k) blind.at((begin + k) % kBins) = true;
  }
  return {eye_, blind};
}

std::vector<std::string> unseen_moves(const routines::Plan& plan, const BlindArea& blind,
                                      const ObstacleOptions& options) {
  std::vector<std::string> names;
  // A plan has many moves and few ways to move.
  std::map<std::pair<double, double>, bool> unseen;
  for (const Move& move : plan.moves) {
    if (std::find(names.begin(), names.end(), move.name) != names.end()) continue;
    const Twist twist = fastest_twist(move, plan.limits);
    const auto [known, is_new] = unseen.try_emplace({twist.v, twist.w}, false);
    if (is_new) known->second = goes_unseen(twist, blind, options);
    if (known->second) names.push_back(move.name);
  }
  return names;
}

}  // namespace odomcalib::safety
