// Cosines and sines: of an angle, or of what comes back with a period.
#pragma once

#include "calib/terms/bases/argument.hpp"
#include "calib/terms/bases/basis_values.hpp"

namespace odomcalib::calib::terms {

/// Harmonics of an angle, together; higher ones are tried one by one.
inline constexpr int kHarmonics = 3;

/// Cosine and sine of the first three multiples of the covariate, or of a single one.
struct Harmonics {
  int only = 0;           ///< which multiple alone; 0: the first three
  bool constant = false;  ///< with a constant as the first function
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const Harmonics&, const Harmonics&) = default;
};

/// One cosine and one sine of time, of a distance, or of a wheel's angle.
struct Cycle {
  double period = 1.0;  ///< in the unit of the covariate, positive
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const Cycle&, const Cycle&) = default;
};

}  // namespace odomcalib::calib::terms
