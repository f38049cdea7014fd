// Legendre polynomials.
#pragma once

#include "calib/terms/bases/argument.hpp"
#include "calib/terms/bases/basis_values.hpp"

namespace odomcalib::calib::terms {

/// Highest degree of the polynomials of a term; one that was found may be as plain as the least.
inline constexpr int kHighestDegree = 4, kPlainest = 1;

/// Degree 1 to `degree` on the covariate's range, clamped outside. Zero at rest where the covariate has a
/// rest, so that the base parameters keep their meaning of slow, steady motion; time has none.
struct Polynomials {
  int degree = kHighestDegree;
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const Polynomials&, const Polynomials&) = default;
};

}  // namespace odomcalib::calib::terms
