#include "calib/terms/bases/cycle.hpp"

#include "calib/math/se2.hpp"
#include "calib/terms/bases/harmonics.hpp"

namespace odomcalib::calib::terms {

BasisValues Cycle::values(const Argument& at) const {
  return harmonics(2.0 * math::kPi * at.z / period, 1, 1);
}

}  // namespace odomcalib::calib::terms
