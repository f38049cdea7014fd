// Numbers in the texts that calib writes.
#pragma once

#include <string>

namespace odomcalib::calib::math {

/// The number to so many significant digits, without trailing zeros; very large and small ones with an
/// exponent.
std::string significant(double value, int digits);

}  // namespace odomcalib::calib::math
