// Functions of a speed or a force, by many smooth pieces.
#pragma once

#include <vector>

#include "calib/terms/bases/argument.hpp"
#include "calib/terms/bases/basis_values.hpp"

namespace odomcalib::calib::terms {

/// The most knots over the magnitude of a speed to describe a term.
inline constexpr int kMostKnots = 24;
/// How rough a term may be that is described: deviation of the second differences of neighbouring splines, in
/// typical sizes.
inline constexpr std::array<double, 4> kRoughness = {0.04, 0.16, 0.64, 2.56};

/// Cubic splines of the magnitude, zero at rest, and what the direction adds. They are smooth by a prior on
/// their second differences (P-splines, Eilers and Marx, Stat. Sci. 11, 1996, eq. 6). Accelerations may take
/// them too: a term of the side that is pushed has a step.
struct Splines {
  int knots = kMostKnots;
  /// How rough the term may be: expected deviation of each second difference of neighbouring splines, in
  /// typical sizes; none: each spline by itself.
  std::vector<double> roughness = {};
  [[nodiscard]] BasisValues values(const Argument& at) const;
  /// Sums of coefficients that are expected to be zero with deviation 1.
  /// @param strength, typical_size whose product roughness is counted in
  /// @param count number of the basis' functions
  [[nodiscard]] std::vector<std::vector<double>> penalty(double strength, double typical_size,
                                                         std::size_t count) const;
  friend bool operator==(const Splines&, const Splines&) = default;
};

}  // namespace odomcalib::calib::terms
