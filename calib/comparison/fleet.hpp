// The robot of several that needs somebody first.
#pragma once

#include <optional>
#include <span>

#include "calib/comparison/difference.hpp"

namespace odomcalib::calib::comparison {

/// The most urgent first.
enum class Urgency {
  refused,   ///< the newest calibration was refused: nobody knows
  changed,   ///< it differs from the one before by more than chance
  warnings,  ///< it was accepted with warnings
  none
};

/// As texts and JSON have it.
const char* name_of(Urgency urgency);

/// Standing of one robot.
struct RobotStanding {
  Urgency urgency = Urgency::none;
  std::optional<Difference> since_last;  ///< between the newest two that were not refused
  double size = 0.0;  ///< of what odometry with the values before would read too much, over what is driven:
                      ///< the larger of the share of a metre and that of a turn; 0 with nothing to compare

  /// Larger sizes first where both are alike.
  [[nodiscard]] bool is_before(const RobotStanding& other) const;
};

/// @param newest of one robot
/// @param usable those of its calibrations that can be compared, in order of time
RobotStanding standing_of(const Calibration& newest, std::span<const Calibration* const> usable);

}  // namespace odomcalib::calib::comparison
