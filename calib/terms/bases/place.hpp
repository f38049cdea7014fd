// Functions of the place: smooth ones, and some that have edges.
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

/// Knots each way over a place with patches: a rug has an edge, which no polynomial has.
inline constexpr int kPatches = 4;

/// Bilinear between the knots, one after another along x for each along y.
struct Patches {
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const Patches&, const Patches&) = default;
};

}  // namespace odomcalib::calib::terms
