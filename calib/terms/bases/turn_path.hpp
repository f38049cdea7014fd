// Functions for what a turn of either direction adds to the path.
#pragma once

#include "calib/terms/bases/argument.hpp"
#include "calib/terms/bases/basis_values.hpp"

namespace odomcalib::calib::terms {

/// A constant, the magnitude of the speed, its direction, and both times each other. The constant belongs to
/// no base parameter here.
struct TurnPath {
  [[nodiscard]] BasisValues values(const Argument& at) const;
  /// Where turns of one speed cannot show which, each radian leaves the same way.
  [[nodiscard]] static double prior(std::size_t function, double usual) {
    return function > 0 ? 0.25 * usual : usual;
  }
  friend bool operator==(const TurnPath&, const TurnPath&) = default;
};

}  // namespace odomcalib::calib::terms
