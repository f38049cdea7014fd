#include "calib/terms/bases/place.hpp"

namespace odomcalib::calib::terms {

BasisValues Patches::values(const Argument& at) const {
  const auto place = [&](double value) { return 0.5 * (at.scaled(value) + 1.0) * (kPatches - 1); };
  const double along = place(at.interval.x), across = place(at.interval.y);
  BasisValues functions;
  for (int j = 0; j < kPatches; ++j)
    for (int i = 0; i < kPatches; ++i) functions.push_back(hat(along - i) * hat(across - j));
  return functions;
}

}  // namespace odomcalib::calib::terms
