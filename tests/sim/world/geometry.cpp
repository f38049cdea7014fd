#include "tests/sim/world/geometry.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

namespace odomcalib::sim {

namespace {

double squared_distance(Vec2 start, Vec2 span, Vec2 point) {
  const double length2 = span.x * span.x + span.y * span.y;
  const double along = (point.x - start.x) * span.x + (point.y - start.y) * span.y;
  const double share = length2 > 0.0 ? std::clamp(along / length2, 0.0, 1.0) : 0.0;
  const double dx = start.x + share * span.x - point.x;
  const double dy = start.y + share * span.y - point.y;
  return dx * dx + dy * dy;
}

}  // namespace

Room& Room::add_wall(Vec2 from, Vec2 to) {
  walls_.push_back({from, {to.x - from.x, to.y - from.y}});
  return *this;
}

Room& Room::add_polygon(std::span<const Vec2> corners) {
  for (std::size_t i = 0; i < corners.size(); ++i) add_wall(corners[i], corners[(i + 1) % corners.size()]);
  return *this;
}

Room& Room::add_box(Vec2 centre, Vec2 size, double yaw) {
  const Pose frame{centre.x, centre.y, yaw};
  std::array<Vec2, 4> corners;
  constexpr std::array<Vec2, 4> kSigns{{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Pose corner = compose(frame, {kSigns[i].x * size.x, kSigns[i].y * size.y, 0.0});
    corners[i] = {corner.x, corner.y};
  }
  return add_polygon(corners);
}

Room& Room::add_pillar(Vec2 centre, double radius, int sides) {
  std::vector<Vec2> corners;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / sides;
    corners.push_back({centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)});
  }
  return add_polygon(corners);
}

std::optional<Hit> Room::cast(Vec2 origin, double direction) const {
  const double ux = std::cos(direction), uy = std::sin(direction);
  double best = std::numeric_limits<double>::infinity();
  const Wall* struck = nullptr;
  for (const Wall& wall : walls_) {
    // origin + range * u = start + share * span, solved by crossing with span and with u.
    const double denominator = ux * wall.span.y - uy * wall.span.x;
    if (denominator == 0.0) continue;
    const double ox = wall.start.x - origin.x, oy = wall.start.y - origin.y;
    const double range = (ox * wall.span.y - oy * wall.span.x) / denominator;
    if (range <= 0.0 || range >= best) continue;
    const double share = (ox * uy - oy * ux) / denominator;
    if (share < 0.0 || share > 1.0) continue;
    best = range;
    struck = &wall;
  }
  if (struck == nullptr) return std::nullopt;
  const double across = std::abs(ux * struck->span.y - uy * struck->span.x);
  return Hit{best, across / std::hypot(struck->span.x, struck->span.y)};
}

double Room::clearance(Vec2 point) const {
  double best = std::numeric_limits<double>::infinity();
  for (const Wall& wall : walls_) best = std::min(best, squared_distance(wall.start, wall.span, point));
  return std::sqrt(best);
}

}  // namespace odomcalib::sim
