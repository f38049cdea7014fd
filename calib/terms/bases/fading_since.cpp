#include "calib/terms/bases/fading_since.hpp"

namespace odomcalib::calib::terms {
namespace {

constexpr double kNearestLength = 0.03;  ///< m of the base
constexpr double kNearestAngle = 0.2;    ///< rad of a wheel

}  // namespace

BasisValues FadingSince::values(const Argument& at) const {
  const bool of_wheel = at.dependence.covariate == vehicle::Covariate::left_since_reversal ||
                        at.dependence.covariate == vehicle::Covariate::right_since_reversal;
  const double nearest = of_wheel ? kNearestAngle : kNearestLength;
  const double place = std::log2(std::max(at.z, nearest) / nearest);
  BasisValues functions;
  for (int k = 0; k < kFadeKnots; ++k) functions.push_back(hat(place - k));
  return functions;
}

double FadingSince::prior(std::size_t function, double usual) {
  return std::ldexp(usual, kFadeKnots - 1 - static_cast<int>(function));
}

}  // namespace odomcalib::calib::terms
