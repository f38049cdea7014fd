// A calibration as configuration of what drives a robot.
#pragma once

#include <string>
#include <vector>

#include "proto/calibration/calibration.hpp"

namespace odomcalib::cli {

/// Whether robots are driven by it: then a refused calibration is not exported.
bool is_configuration(const std::string& what);

/// Names that `configuration` takes.
const std::vector<std::string>& configurations();

/// What odometry, or a comparison of it with the lidar, would need of this calibration and the format has no
/// room for: a sentence each. The text of
/// the format has them as comments.
std::vector<std::string> not_held(const Calibration& calibration, const std::string& what);

/// What odometry errs by without its effects (degrees a turn, mm a metre, where the recording shows them),
/// and what applies them: a sentence. Empty where it has none.
/// @param is_step of odometry as source, which has most of them
std::string lost_without_effects(const Calibration& calibration, bool is_step);

/// Begins with where the values are from, as a comment.
/// Errors: usage (unknown name), format (the file does not hold it), refused.
/// @param where the calibration is from, for errors
Result<std::string> configuration(const Calibration& calibration, const std::string& what,
                                  const std::string& where);

}  // namespace odomcalib::cli
