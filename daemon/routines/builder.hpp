// Moves that are undone by their opposite, so that the robot is near its start after each block.
#pragma once

#include <numbers>
#include <vector>

#include "daemon/routines/motion.hpp"

namespace odomcalib::routines {

struct Builder {
  /// Short rests: a rest costs time, but each one is a chance to match scans of a standing robot.
  static constexpr double kRest = 0.5;
  std::vector<Move> moves;
  double half;   // m, of the shorter side of the area
  double scale;  // of all lengths; 1 for an area of 2 m

  void out_and_back(double distance, double speed, double late = 0.0) {
    moves.push_back(straight(distance, speed, kRest));
    moves.back().late_pace = late;
    moves.push_back(straight(-distance, speed, kRest));
  }
  void both_spins(double angle, double rate) {
    moves.push_back(spin(angle, rate, kRest));
    moves.push_back(spin(-angle, rate, kRest));
  }
  /// All four combinations of signs of speed and turn rate, back at the start after each pair.
  void four_arcs(double radius, double angle, double rate) {
    for (const double side : {1.0, -1.0}) {
      moves.push_back(arc(radius, side * angle, rate, true, kRest));
      moves.push_back(arc(radius, -side * angle, rate, false, kRest));
    }
  }
  void face(double heading) { moves.push_back(turn_to(heading, 0.5)); }
};

}  // namespace odomcalib::routines
