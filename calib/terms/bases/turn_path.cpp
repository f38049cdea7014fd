#include "calib/terms/bases/turn_path.hpp"

#include "calib/terms/bases/speed_hats.hpp"

namespace odomcalib::calib::terms {

BasisValues TurnPath::values(const Argument& at) const {
  const double relative = at.relative();
  return {1.0, std::abs(relative), direction_of(relative), relative};
}

}  // namespace odomcalib::calib::terms
