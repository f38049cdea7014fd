// A mast that sways.
#pragma once

#include "calib/terms/bases/argument.hpp"
#include "calib/terms/bases/basis_values.hpp"

namespace odomcalib::calib::terms {

/// The covariate and its signed square: both directions alike, more than linear at most by a square.
struct Sway {
  [[nodiscard]] BasisValues values(const Argument& at) const;
  friend bool operator==(const Sway&, const Sway&) = default;
};

}  // namespace odomcalib::calib::terms
