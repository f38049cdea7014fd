// Dead reckoning with a calibration as one file of source that needs no library.
#pragma once

#include <string>

#include "proto/calibration/calibration.hpp"

namespace odomcalib::cli {

/// Whether the file applies an effect of that name; curves it does not.
bool is_in_step(const std::string& effect);

/// C99. @param calibration that states its lengths and counts a turn
std::string step_in_c(const Calibration& calibration);
/// Python 3.
std::string step_in_python(const Calibration& calibration);

}  // namespace odomcalib::cli
