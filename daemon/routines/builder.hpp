// Moves that are undone by their opposite, so that the robot is near its start after each block.
#pragma once

#include <numbers>
#include <vector>

#include "daemon/routines/motion.hpp"
#include "daemon/routines/settings.hpp"

namespace odomcalib::routines {

struct Builder {
  std::vector<Move> moves;
  double half;   // m, of the shorter side of the area
  double scale;  // of all lengths; 1 for an area of 2 m

  void out_and_back(double distance, double speed, double late = 0.0) {
    moves.push_back(straight(distance, speed, settings::kShortRest_s));
    moves.back().late_pace = late;
    moves.push_back(straight(-distance, speed, settings::kShortRest_s));
  }
  void both_spins(double angle, double rate) {
    moves.push_back(spin(angle, rate, settings::kShortRest_s));
    moves.push_back(spin(-angle, rate, settings::kShortRest_s));
  }
  /// All four combinations of signs of speed and turn rate, back at the start after each pair.
  void four_arcs(double radius, double angle, double rate) {
    for (const double side : {1.0, -1.0}) {
      moves.push_back(arc(radius, side * angle, rate, true, settings::kShortRest_s));
      moves.push_back(arc(radius, -side * angle, rate, false, settings::kShortRest_s));
    }
  }
  void face(double heading) { moves.push_back(turn_to(heading, settings::kFacing_rad_s)); }
};

}  // namespace odomcalib::routines
