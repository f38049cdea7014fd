// A calibration as text for other programs.
#pragma once

#include <string>
#include <vector>

#include "calib/measurement/sample_pair.hpp"
#include "proto/calibration/calibration.hpp"

namespace odomcalib::cli {

/// Names that `exported` takes.
const std::vector<std::string>& export_formats();

/// Errors: usage (unknown name), format (the file does not hold it), refused.
/// @param where the calibration is from, for errors
Result<std::string> exported(const Calibration& calibration, const std::string& what,
                             const std::string& where = "calibration file");

/// Measured motions beside those of odometry, with their times: CSV in m, rad and s.
/// @param recordings names, in the order in which they were solved
std::string pairs_csv(const std::vector<calib::measurement::SamplePair>& pairs,
                      const std::vector<std::string>& recordings);

}  // namespace odomcalib::cli
