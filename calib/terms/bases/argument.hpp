// The values of one interval that a basis sees.
#pragma once

#include <algorithm>
#include <cmath>

#include "calib/vehicle/channel.hpp"

namespace odomcalib::calib::terms {

struct Argument {
  double z;                              ///< the covariate, in its unit
  double low, high;                      ///< its range in the drives that the smooth term was fitted to
  vehicle::Dependence dependence;        ///< which covariate it is, and on what the smooth term acts
  const vehicle::StepContext& interval;  ///< for what takes more than one covariate

  /// A value of the covariate on its range, -1 to 1, clamped outside.
  [[nodiscard]] double scaled(double value) const {
    return std::clamp(2.0 * (value - low) / (high - low) - 1.0, -1.0, 1.0);
  }
  /// The covariate as a share of the largest magnitude in its range, -1 to 1, clamped outside.
  [[nodiscard]] double relative() const {
    return std::clamp(z / std::max(std::abs(low), std::abs(high)), -1.0, 1.0);
  }
};

}  // namespace odomcalib::calib::terms
