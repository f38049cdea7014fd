#include "calib/terms/bases/harmonics.hpp"

#include <complex>

namespace odomcalib::calib::terms {

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

BasisValues Harmonics::values(const Argument& at) const {
  if (only > 0) return harmonics(at.z, only, only);
  const BasisValues waves = harmonics(at.z, 1, kHarmonics);
  if (!constant) return waves;
  BasisValues all{1.0};
  for (const double f : waves) all.push_back(f);
  return all;
}

}  // namespace odomcalib::calib::terms
