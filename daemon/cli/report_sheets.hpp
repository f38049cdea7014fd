// Two pages of one sheet each: for the person at the robot, and to be filed.
#pragma once

#include <string>

#include "proto/calibration/calibration.hpp"

namespace odomcalib::cli {

/// The base from above, what was found where, what to look at, and what the software corrects by itself.
std::string mechanics_sheet(const Calibration& calibration);

/// Robot, date, place, digests, values with both deviations, the metre that they stand on, the error before
/// and after, version.
/// @param sha256 of the calibration file's bytes
std::string certificate(const Calibration& calibration, const std::string& file, const std::string& sha256);

}  // namespace odomcalib::cli
