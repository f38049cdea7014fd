// Functions that fade with the distance since an event.
#pragma once

#include "calib/terms/bases/argument.hpp"
#include "calib/terms/bases/basis_values.hpp"

namespace odomcalib::calib::terms {

/// Knots over the distance since an event, each at twice the distance of the one before.
inline constexpr int kFadeKnots = 4;

/// Piecewise linear in the logarithm of the distance, flat towards zero, nothing beyond the last knot's
/// double.
struct FadingSince {
  [[nodiscard]] BasisValues values(const Argument& at) const;
  /// The loss between one knot and the next is as much everywhere, the way between them half as long.
  /// @param usual deviation that is expected of a coefficient
  [[nodiscard]] static double prior(std::size_t function, double usual);
  friend bool operator==(const FadingSince&, const FadingSince&) = default;
};

}  // namespace odomcalib::calib::terms
