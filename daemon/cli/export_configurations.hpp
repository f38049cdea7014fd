// A calibration as configuration of what drives a robot.
#pragma once

#include <string>

#include "proto/calibration/calibration.hpp"

namespace odomcalib::cli {

/// Whether robots are driven by it: then a refused calibration is not exported.
bool is_configuration(const std::string& what);

/// Errors: usage (unknown name), format (the file does not hold it), refused.
/// @param where the calibration is from, for errors
Result<std::string> configuration(const Calibration& calibration, const std::string& what,
                                  const std::string& where);

}  // namespace odomcalib::cli
