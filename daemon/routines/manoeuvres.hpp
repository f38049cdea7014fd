// Single manoeuvres of about a minute, each for one question that a calibration may leave open, and the
// pattern that keeps all parameters and effects apart.
#pragma once

#include <optional>
#include <string>

#include "daemon/routines/motion.hpp"

namespace odomcalib::routines {

struct PatternOptions {
  /// Free area around the start, m: its length along the start heading and its width. The middle of the axle
  /// stays inside; the robot's own size must be free beyond it.
  double area_length = 2.0;
  double area_width = 2.0;
  double track_width = 0.4;  ///< m, nominal: radius of the single-wheel turns
  bool quick = false;        ///< a quarter of the time, fewer speeds
  Limits limits;
};

/// straights, slow_straights, turns, arcs, accelerations, reversals, headings; nullopt for another name.
std::optional<Plan> manoeuvre_plan(const std::string& name, const PatternOptions& options);

/// Every direction, every speed slowly and several steadily, several radii, single wheels, four headings,
/// many starts and stops of different strengths and lengths, and the first straight once more at the end
/// (drift). Every move is undone by its opposite, so that the robot is near its start after each block:
/// driven from the odometry pose with a Runner it stays inside the area. About five and a half minutes,
/// quick: one and a half.
Plan pattern_plan(const PatternOptions& options);

}  // namespace odomcalib::routines
