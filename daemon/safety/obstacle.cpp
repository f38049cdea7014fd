#include "daemon/safety/obstacle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/safety/settings.hpp"

namespace odomcalib::safety {
namespace {

using routines::Pose;
using routines::Twist;

Point seen_from(const Pose& pose, const Point& point) {
  const double dx = point.x - pose.x;
  const double dy = point.y - pose.y;
  const double c = std::cos(pose.yaw);
  const double s = std::sin(pose.yaw);
  return {c * dx + s * dy, -s * dx + c * dy};
}

bool on_path(const Point& point, const std::vector<Pose>& path, const ObstacleOptions& options) {
  return std::any_of(path.begin(), path.end(), [&](const Pose& pose) {
    return inside(seen_from(pose, point), options.footprint, options.side_margin);
  });
}

}  // namespace

bool inside(const Point& point, const Footprint& footprint, double grow) {
  return point.x <= footprint.front + grow && point.x >= -footprint.back - grow &&
         std::abs(point.y) <= footprint.half_width + grow;
}

std::vector<Pose> path_of(const Twist& twist, double distance) {
  const double duration = distance / std::abs(twist.v);
  std::vector<Pose> path(1);
  for (int i = 0; i < settings::kArcSteps; ++i) {
    Pose pose = path.back();
    const double dt = duration / settings::kArcSteps;
    const double middle = pose.yaw + 0.5 * twist.w * dt;
    pose.x += twist.v * dt * std::cos(middle);
    pose.y += twist.v * dt * std::sin(middle);
    pose.yaw += twist.w * dt;
    path.push_back(pose);
  }
  return path;
}

bool is_spin(const Twist& twist) { return std::abs(twist.v) < settings::kSpin_m_s; }

double Footprint::radius() const { return std::hypot(std::max(front, back), half_width); }

std::vector<Point> points_of(const Scan& scan, const std::array<double, 3>& lidar_pose) {
  std::vector<Point> points;
  points.reserve(scan.ranges.size());
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
    const double range = static_cast<double>(scan.ranges[i]);
    if (!(range > 0.0) || range < scan.range_min || range > scan.range_max) continue;
    const double angle = scan.angle(i) + lidar_pose[2];
    points.push_back({lidar_pose[0] + range * std::cos(angle), lidar_pose[1] + range * std::sin(angle)});
  }
  return points;
}

double fastest_with(double watchdog_time) { return settings::kMargin_m / watchdog_time; }

double stopping_distance(double speed, const ObstacleOptions& options) {
  const double v = std::abs(speed);
  return v * options.reaction + v * v / (2.0 * options.acceleration) + options.margin;
}

std::vector<Point> in_way(const std::vector<Point>& points, const Twist& twist,
                          const ObstacleOptions& options) {
  std::vector<Point> found;
  if (twist.v == 0.0 && twist.w == 0.0) return found;
  const double circle = options.footprint.radius() + options.side_margin;
  const auto path =
      is_spin(twist) ? std::vector<Pose>{} : path_of(twist, stopping_distance(twist.v, options));
  const auto counts = [&](const Point& point) {
    if (inside(point, options.footprint, 0.0)) return false;
    return is_spin(twist) ? std::hypot(point.x, point.y) <= circle : on_path(point, path, options);
  };
  std::copy_if(points.begin(), points.end(), std::back_inserter(found), counts);
  return found;
}

ObstacleOptions ObstacleGuard::options() const {
  ObstacleOptions measured = options_;
  measured.reaction += overrun_;
  return measured;
}

std::optional<std::string> ObstacleGuard::obstacle() const {
  if (!nearest_) return std::nullopt;
  return fmt::format("something is in the way, {:.2f} m {} and {:.2f} m to the {} of the robot's middle",
                     std::abs(nearest_->x), nearest_->x < 0.0 ? "behind" : "ahead", std::abs(nearest_->y),
                     nearest_->y < 0.0 ? "right" : "left");
}

void ObstacleGuard::seen(const std::vector<Point>& points, const Twist& twist) {
  const auto found = in_way(points, twist, options());
  if (static_cast<int>(found.size()) >= options_.points) {
    nearest_ = *std::min_element(found.begin(), found.end(), [](const Point& a, const Point& b) {
      return std::hypot(a.x, a.y) < std::hypot(b.x, b.y);
    });
    free_scans_ = 0;
  } else if (nearest_ && ++free_scans_ >= options_.release_scans) {
    nearest_.reset();
  }
}

void ObstacleGuard::turned(double t) {
  if (!scan_times_.empty() && t <= scan_times_.back()) return;
  scan_times_.push_back(t);
  if (scan_times_.size() > settings::kPeriods + 1) scan_times_.pop_front();
  if (scan_times_.size() < 2) return;
  double period = 0.0;
  for (std::size_t i = 1; i < scan_times_.size(); ++i)
    period = std::max(period, scan_times_[i] - scan_times_[i - 1]);
  options_.reaction = std::min(period, settings::kScanTimeout) + settings::kReaction_s;
}

double reach_of(const Footprint& footprint, double clearance) {
  return std::hypot(std::max(footprint.front, footprint.back) + clearance, footprint.half_width + clearance);
}

std::optional<std::string> occupied(const std::vector<Point>& points, const routines::Preview& preview,
                                    const Footprint& footprint, double clearance) {
  // Most points are far from most of a way: that costs no sine.
  constexpr double kRounding = 1e-9;  // m
  const double reach = reach_of(footprint, clearance) + kRounding;
  for (const Point& point : points) {
    if (std::hypot(point.x, point.y) > preview.reach + reach) continue;
    const auto near = [&](const Pose& pose) {
      const double dx = point.x - pose.x, dy = point.y - pose.y;
      return dx * dx + dy * dy <= reach * reach && inside(seen_from(pose, point), footprint, clearance);
    };
    if (!inside(point, footprint, 0.0) && std::any_of(preview.path.begin(), preview.path.end(), near))
      return fmt::format(
          "something stands {:.2f} m ahead and {:.2f} m to the left of the robot, nearer than "
          "{:.2f} m to its way",
          point.x, point.y, clearance);
  }
  return std::nullopt;
}

}  // namespace odomcalib::safety
