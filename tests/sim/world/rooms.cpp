#include "tests/sim/world/rooms.hpp"

#include <numbers>

#include "tests/sim/world/random.hpp"

namespace odomcalib::sim {

namespace {

/// Rectangle with some corners cut off at random slants.
std::vector<Vec2> random_outline(Random& random, double west, double east, double south, double north) {
  const std::array<Vec2, 4> corners{{{west, south}, {east, south}, {east, north}, {west, north}}};
  std::vector<Vec2> outline;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (uniform(random, 0.0, 1.0) < 0.5) {
      outline.push_back(corners[i]);
      continue;
    }
    const double cut_x = uniform(random, 0.3, 0.9) * (corners[i].x > 0.0 ? -1.0 : 1.0);
    const double cut_y = uniform(random, 0.3, 0.9) * (corners[i].y > 0.0 ? -1.0 : 1.0);
    const Vec2 on_x{corners[i].x + cut_x, corners[i].y}, on_y{corners[i].x, corners[i].y + cut_y};
    const bool horizontal_first = i % 2 == 1;  // walking counter-clockwise, edges alternate in direction
    outline.push_back(horizontal_first ? on_x : on_y);
    outline.push_back(horizontal_first ? on_y : on_x);
  }
  return outline;
}

/// One piece of furniture between the free circle and the walls.
void add_random_furniture(Random& random, Room& room, Vec2 position, double space) {
  const double size = std::min(uniform(random, 0.3, 0.9), space);
  if (uniform(random, 0.0, 1.0) < 0.35) {
    room.add_pillar(position, 0.3 * size);
  } else {
    room.add_box(position, {size, size * uniform(random, 0.4, 0.7)}, uniform(random, 0.0, std::numbers::pi));
  }
}

}  // namespace

Room box_room(double length, double width, double x_behind, double y_right) {
  Room room;
  room.add_box({0.5 * length - x_behind, 0.5 * width - y_right}, {length, width});
  return room;
}

Room furnished_room() {
  Room room;
  const std::array<Vec2, 6> outline{
      {{-3.5, -3.0}, {4.5, -3.0}, {4.5, 2.1}, {3.2, 3.5}, {-3.5, 3.5}, {-3.5, 0.8}}};
  room.add_polygon(outline);
  room.add_box({-2.9, -2.6}, {0.9, 0.5})
      .add_box({1.2, 3.1}, {1.6, 0.6})
      .add_box({3.9, -1.4}, {0.6, 1.2}, 0.2);
  room.add_box({-2.6, 2.4}, {0.7, 0.7}, 0.6).add_pillar({2.4, -2.3}, 0.25).add_pillar({-3.0, 0.2}, 0.18);
  room.add_wall({0.4, -3.0}, {0.9, -2.5}).add_wall({0.9, -2.5}, {1.2, -3.0});
  return room;
}

Room workshop() {
  Room room;
  const std::array<Vec2, 6> outline{
      {{-4.0, -3.2}, {7.0, -3.2}, {7.0, 2.4}, {2.6, 2.4}, {2.6, 5.8}, {-4.0, 5.8}}};
  room.add_polygon(outline);
  room.add_box({-3.6, 1.0}, {0.8, 2.4}).add_box({2.2, -2.8}, {2.0, 0.8}).add_box({5.4, 0.4}, {0.7, 1.3}, 0.4);
  room.add_box({0.2, 5.3}, {2.4, 0.7}).add_box({-2.4, 3.9}, {0.6, 0.9}, 1.1).add_pillar({4.2, -1.9}, 0.2);
  room.add_pillar({-2.5, -2.4}, 0.15).add_pillar({1.6, 3.6}, 0.2);
  return room;
}

Room round_room() {
  Room room;
  room.add_pillar({0.3, 0.2}, 3.4, 360).add_pillar({2.6, 1.4}, 0.35, 60);
  room.add_pillar({-1.9, 1.9}, 0.3, 60).add_pillar({-0.4, -2.5}, 0.4, 60);
  return room;
}

Room corridor() { return box_room(40.0, 1.8, 20.0, 0.9); }

Room random_room(std::uint64_t seed, double free_radius) {
  Random random(seed ^ 0x726f6f6dULL);
  const double length = uniform(random, 6.0, 12.0), width = uniform(random, 6.0, 12.0);
  const double reserve = free_radius + 0.9;  // keeps the walls and their cut corners off the free circle
  const double west =
      -uniform(random, std::min(reserve, 0.5 * length), std::max(length - reserve, 0.5 * length));
  const double south =
      -uniform(random, std::min(reserve, 0.5 * width), std::max(width - reserve, 0.5 * width));
  Room room;
  room.add_polygon(random_outline(random, west, west + length, south, south + width));
  const int pieces = std::uniform_int_distribution<int>(4, 9)(random);
  for (int placed = 0, tries = 0; placed < pieces && tries < 200; ++tries) {
    const Vec2 position{uniform(random, west, west + length), uniform(random, south, south + width)};
    const double space = std::hypot(position.x, position.y) - free_radius;
    if (space < 0.5) continue;
    add_random_furniture(random, room, position, space);
    ++placed;
  }
  return room;
}

}  // namespace odomcalib::sim
