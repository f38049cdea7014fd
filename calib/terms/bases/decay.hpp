// A function that fades away with time.
#pragma once

#include "calib/terms/bases/argument.hpp"
#include "calib/terms/bases/basis_values.hpp"

namespace odomcalib::calib::terms {

/// exp(-t / time constant), so that the base is what it comes to, as of a lidar once it is warm.
struct Decay {
  double time_constant = 1.0;  ///< s, positive
  [[nodiscard]] BasisValues values(const Argument& at) const { return {std::exp(-at.z / time_constant)}; }
  friend bool operator==(const Decay&, const Decay&) = default;
};

}  // namespace odomcalib::calib::terms
