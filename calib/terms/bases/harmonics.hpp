// Fourier series of an angle.
#pragma once

#include "calib/terms/bases/argument.hpp"
#include "calib/terms/bases/basis_values.hpp"

namespace odomcalib::calib::terms {

/// Harmonics of an angle, together; higher ones are tried one by one.
inline constexpr int kHarmonics = 3;

/// Cosines and sines of the first to the last multiple of an angle, by rotating on from one to the next.
BasisValues harmonics(double angle, int first, int last);

/// Cosine and sine of the first three multiples of the covariate, or of a single one.
struct Harmonics {
  int only = 0;           ///< which multiple alone; 0: the first three
  bool constant = false;  ///< with a constant as the first function
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const Harmonics&, const Harmonics&) = default;
};

}  // namespace odomcalib::calib::terms
