// A calibration as text for other programs.
#pragma once

#include <string>
#include <vector>

#include "proto/calibration.hpp"

namespace odomcalib::cli {

/// Names that `exported` takes.
const std::vector<std::string>& export_formats();

/// Errors: usage (unknown name), empty (the file does not hold it).
Result<std::string> exported(const Calibration& calibration, const std::string& what);

}  // namespace odomcalib::cli
