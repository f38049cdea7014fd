// Functions of the place that have edges.
#pragma once

#include "calib/terms/bases/argument.hpp"
#include "calib/terms/bases/basis_values.hpp"

namespace odomcalib::calib::terms {

/// Knots each way over a place with patches: a rug has an edge, which no polynomial has.
inline constexpr int kPatches = 4;

/// Bilinear between the knots, one after another along x for each along y.
struct Patches {
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const Patches&, const Patches&) = default;
};

}  // namespace odomcalib::calib::terms
