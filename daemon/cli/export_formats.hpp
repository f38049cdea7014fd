// A calibration as text for other programs.
#pragma once

#include <string>
#include <vector>

#include "proto/calibration/calibration.hpp"

namespace odomcalib::cli {

/// Names that `exported` takes.
const std::vector<std::string>& export_formats();

/// Whether robots are driven by it: then a refused calibration is not exported.
bool is_configuration(const std::string& what);

/// Errors: usage (unknown name), format (the file does not hold it), refused.
/// @param where the calibration is from, for errors
Result<std::string> exported(const Calibration& calibration, const std::string& what,
                             const std::string& where = "calibration file");

}  // namespace odomcalib::cli
