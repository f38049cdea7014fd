// Where does each wire go? A nudge of a few centimetres ahead and a few degrees to the left, at speeds
// commanded and not controlled, shows it by its signs alone: which way each count went, and how the lidar saw
// itself move. Every combination of faults predicts these signs; the combination with the fewest faults that
// predicts what was seen is the explanation, before anything is fitted.
//
// Limit of a nudge: a world seen in a mirror is a possible world. With the lidar's zero towards the
// front, both wheels exchanged and a lidar upside down look the same. Then both are named, and a look at the
// robot decides.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "daemon/routines/motion.hpp"

namespace odomcalib::routines {

/// Two moves, each undone by its opposite, driven by time and not by counts: wrong counts must not steer.
Plan nudge_plan(const Limits& limits);

/// Result of one of the two moves; that of its opposite is turned round and averaged in.
struct NudgeMove {
  std::array<double, 2> commanded{};  ///< rad of the left and the right wheel, forward positive
  std::array<double, 2> counted{};    ///< rad, as the counts of left and right say
  std::optional<Pose>
      seen;  ///< motion of the lidar in its own axes at the start, m, m, rad; nullopt: no match
};

struct Nudge {
  NudgeMove ahead, left;
  double wheel_radius = 0.0;  ///< m, nominal
  double track_width = 0.0;   ///< m, nominal
  double lidar_yaw = 0.0;     ///< rad, as configured
};

/// One wire, or one mounting.
struct WiringFault {
  std::string name;  ///< e.g. left_counts_inverted
  std::string what;  ///< for people
  std::string remedy;
};

struct Wiring {
  enum class Outcome { good, wrong, unclear };
  Outcome outcome = Outcome::unclear;
  std::string why;  ///< of unclear
  /// Each explains everything that was seen, with equally few faults. Empty when nothing is wrong, or nothing
  /// is clear.
  std::vector<std::vector<WiringFault>> explanations;
  /// rad, roughly, as the first explanation has it; nullopt when the lidar saw nothing
  std::optional<double> lidar_yaw;
};

Wiring judge_wiring(const Nudge& nudge);

}  // namespace odomcalib::routines
