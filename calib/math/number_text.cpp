#include "calib/math/number_text.hpp"

#include <iomanip>
#include <ios>
#include <sstream>

#include "calib/math/se2.hpp"

namespace odomcalib::calib::math {

std::string significant(double value, int digits) {
  std::ostringstream out;
  out << std::setprecision(digits) << value;
  return out.str();
}

std::string fixed(double value, int decimals) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(decimals) << value;
  return out.str();
}

std::string signed_fixed(double value, int decimals) {
  std::ostringstream out;
  out << std::showpos << std::fixed << std::setprecision(decimals) << value;
  return out.str();
}

std::string five_characters(double value) { return std::to_string(value).substr(0, 5); }

std::string degrees_text(double angle_rad) { return significant(angle_rad * 180.0 / kPi, 3) + " degrees"; }

std::string millimetres_text(double length_m) { return significant(1e3 * length_m, 3) + " mm"; }

}  // namespace odomcalib::calib::math
