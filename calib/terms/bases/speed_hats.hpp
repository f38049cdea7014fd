// Functions of a speed, by few straight pieces.
#pragma once

#include "calib/terms/bases/argument.hpp"
#include "calib/terms/bases/basis_values.hpp"

namespace odomcalib::calib::terms {

/// Knots over the magnitude of a speed to find a term.
inline constexpr int kKnots = 4;

/// Direction as a step, smooth over a few percent of the range so that noise about zero does not flip it.
/// @param relative share of the largest speed, -1 to 1
double direction_of(double relative);

/// The part that each direction adds to functions of the magnitude: a step with the direction, which on the
/// unsigned way that has this direction is a constant, and the magnitude times the direction.
void add_direction(const Argument& at, BasisValues& functions);

/// Piecewise linear in the magnitude, zero at rest, and what the direction adds.
struct SpeedHats {
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const SpeedHats&, const SpeedHats&) = default;
};

}  // namespace odomcalib::calib::terms
