#include "calib/terms/bases/fading_since.hpp"

#include "calib/terms/settings.hpp"

namespace odomcalib::calib::terms {
BasisValues FadingSince::values(const Argument& at) const {
  const double nearest =
      is_angle_of_a_wheel(at.dependence.covariate) ? settings::kNearestKnot_rad : settings::kNearestKnot_m;
  const double place = std::log2(std::max(at.z, nearest) / nearest);
  BasisValues functions;
  for (int k = 0; k < kFadeKnots; ++k) functions.push_back(hat(place - k));
  return functions;
}

double FadingSince::prior(std::size_t function, double usual) {
  return std::ldexp(usual, kFadeKnots - 1 - static_cast<int>(function));
}

}  // namespace odomcalib::calib::terms
