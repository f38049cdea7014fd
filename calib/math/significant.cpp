#include "calib/math/significant.hpp"

#include <iomanip>
#include <sstream>

namespace odomcalib::calib::math {

std::string significant(double value, int digits) {
  std::ostringstream out;
  out << std::setprecision(digits) << value;
  return out.str();
}

}  // namespace odomcalib::calib::math
