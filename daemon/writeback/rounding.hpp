// Values are rounded to the steps of the controller. The roundings are chosen together, so that the odometry
// made from them errs least; what remains is reported, and the host applies the exact values.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "drivers/base/controller.hpp"

namespace odomcalib {

/// How wrong odometry from the rounded values is.
struct RoundingError {
  double length = 0.0;   ///< m too much per m driven straight
  double heading = 0.0;  ///< rad too much, counter-clockwise, per m driven straight
  double turn = 0.0;     ///< rad too much per rad turned on the spot
};

struct RoundedParameters {
  std::map<std::string, double> values;  ///< SI, by quantity; those without a step as they were
  RoundingError remaining;
};

/// @param wanted left_wheel_diameter, right_wheel_diameter, track_width in m; with one of them missing the
///               controller rounds each value for itself and no error is reported
/// @param held   what the controller holds now: its values and steps are the grid
RoundedParameters round_together(const std::map<std::string, double>& wanted,
                                 const std::vector<drivers::StoredParameter>& held);

}  // namespace odomcalib
