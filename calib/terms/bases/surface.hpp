// Smooth functions of the place.
#pragma once

#include "calib/terms/bases/argument.hpp"
#include "calib/terms/bases/basis_values.hpp"

namespace odomcalib::calib::terms {

/// Polynomials of degree 1 and 2 in x and y, both on one range.
struct Surface {
  [[nodiscard]] static BasisValues values(const Argument& at) {
    const double x = at.scaled(at.interval.x), y = at.scaled(at.interval.y);
    return {x, y, x * x, x * y, y * y};
  }
  friend bool operator==(const Surface&, const Surface&) = default;
};

}  // namespace odomcalib::calib::terms
