// Plane geometry of the simulated world: points, poses, walls and rays. SI units, radians.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace odomcalib::sim {

struct Vec2 {
  double x = 0.0, y = 0.0;
};

/// x forward, y left, yaw counter-clockwise. The yaw is not wrapped, so that turns can be counted.
struct Pose {
  double x = 0.0, y = 0.0, yaw = 0.0;
};

/// Pose of `inner`, given in the frame of `outer`, in the frame that `outer` is given in.
inline Pose compose(const Pose& outer, const Pose& inner) {
  const double c = std::cos(outer.yaw), s = std::sin(outer.yaw);
  return {outer.x + c * inner.x - s * inner.y, outer.y + s * inner.x + c * inner.y, outer.yaw + inner.yaw};
}

/// Where a ray ends: distance in m, and the cosine of the angle between ray and wall normal (0 = grazing).
struct Hit {
  double range = 0.0;
  double incidence_cosine = 1.0;
};

/// A room is a set of straight walls; what is inside and outside does not matter to a ray.
class Room {
 public:
  /// Closed polygon through the points in the given order.
  Room& add_polygon(std::span<const Vec2> corners);
  Room& add_wall(Vec2 from, Vec2 to);
  /// Rectangle of the given size, turned by yaw about its centre.
  Room& add_box(Vec2 centre, Vec2 size, double yaw = 0.0);
  /// Round pillar as a regular polygon whose corners lie on the circle.
  Room& add_pillar(Vec2 centre, double radius, int sides = 16);

  /// Nearest wall in the given direction, or nothing when the ray leaves the room.
  [[nodiscard]] std::optional<Hit> cast(Vec2 origin, double direction) const;
  /// Distance from a point to the nearest wall in m; infinite without walls.
  [[nodiscard]] double clearance(Vec2 point) const;
  [[nodiscard]] std::size_t wall_count() const { return walls_.size(); }

 private:
  struct Wall {
    Vec2 start, span;
  };
  std::vector<Wall> walls_;
};

}  // namespace odomcalib::sim
