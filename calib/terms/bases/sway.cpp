#include "calib/terms/bases/sway.hpp"

namespace odomcalib::calib::terms {

BasisValues Sway::values(const Argument& at) const {
  const double relative = at.relative();
  return {relative, relative * std::abs(relative)};
}

}  // namespace odomcalib::calib::terms
