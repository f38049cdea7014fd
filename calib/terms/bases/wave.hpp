// A floor that repeats itself.
#pragma once

#include "calib/terms/bases/argument.hpp"
#include "calib/terms/bases/basis_values.hpp"

namespace odomcalib::calib::terms {

/// A plane wave over the place: its cosine and sine, a level that comes and goes, and both times the cosine
/// of the angle between the heading and the way across the crests, a slope that lengthens one way and
/// shortens the other.
struct Wave {
  double along_x = 0.0, along_y = 0.0;  ///< cycles per m, not both zero
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const Wave&, const Wave&) = default;
};

}  // namespace odomcalib::calib::terms
