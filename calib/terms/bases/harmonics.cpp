#include "calib/terms/bases/harmonics.hpp"

#include <complex>

#include "calib/math/se2.hpp"

namespace odomcalib::calib::terms {
namespace {

/// Cosines and sines of the first to the last multiple of an angle, by rotating on from one to the next.
BasisValues harmonics(double angle, int first, int last) {
  BasisValues functions;
  const std::complex<double> turn = std::polar(1.0, angle);
  std::complex<double> here = first == 1 ? turn : std::polar(1.0, first * angle);
  for (int k = first; k <= last; ++k, here *= turn) {
    functions.push_back(here.real());
    functions.push_back(here.imag());
  }
  return functions;
}

}  // namespace

BasisValues Harmonics::values(const Argument& at) const {
  if (only > 0) return harmonics(at.z, only, only);
  const BasisValues waves = harmonics(at.z, 1, kHarmonics);
  if (!constant) return waves;
  BasisValues all{1.0};
  for (const double f : waves) all.push_back(f);
  return all;
}

BasisValues Cycle::values(const Argument& at) const {
  return harmonics(2.0 * math::kPi * at.z / period, 1, 1);
}

}  // namespace odomcalib::calib::terms
