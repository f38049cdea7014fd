// Numbers in the texts that calib writes.
#pragma once

#include <string>

namespace odomcalib::calib::math {

/// The number to so many significant digits, without trailing zeros; very large and small ones with an
/// exponent.
std::string significant(double value, int digits);

/// The number with so many decimals, and with its sign in any case.
std::string fixed(double value, int decimals);
std::string signed_fixed(double value, int decimals);

/// The first five characters of a number with six decimals: cut, not rounded.
std::string five_characters(double value);

/// To three significant digits.
std::string degrees_text(double angle_rad);
std::string millimetres_text(double length_m);

}  // namespace odomcalib::calib::math
