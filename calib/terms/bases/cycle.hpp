// Functions that come back with a period.
#pragma once

#include "calib/terms/bases/argument.hpp"
#include "calib/terms/bases/basis_values.hpp"

namespace odomcalib::calib::terms {

/// One cosine and one sine of time, of a distance, or of a wheel's angle.
struct Cycle {
  double period = 1.0;  ///< in the unit of the covariate, positive
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const Cycle&, const Cycle&) = default;
};

}  // namespace odomcalib::calib::terms
