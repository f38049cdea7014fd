// Rooms to drive in. The robot starts at the origin, facing +x, with free space around it.
#pragma once

#include <cstdint>

#include "tests/sim/world/geometry.hpp"

namespace odomcalib::sim {

/// Bare rectangle, its lower left corner at (-x_behind, -y_right).
Room box_room(double length, double width, double x_behind, double y_right);
/// 8 m x 6.5 m with cupboards, a slanted wall and two pillars.
Room furnished_room();
/// 11 m x 9 m, L-shaped, benches along the walls.
Room workshop();
/// A drum of 3.4 m radius with three columns: no wall is straight.
Room round_room();
/// 1.8 m wide and 40 m long without any structure: position along it cannot be seen by a 12 m lidar.
Room corridor();
/// 6 to 12 m on a side, cut or slanted corners, furniture and pillars; at least `free_radius` clear about the
/// origin.
Room random_room(std::uint64_t seed, double free_radius = 1.9);

}  // namespace odomcalib::sim
