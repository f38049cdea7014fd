// The median, and the spread that goes with it: what outliers cannot move.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace odomcalib::calib {

/// Median absolute deviation times this is the standard deviation of normally distributed values.
inline constexpr double kMadToSigma = 1.4826;

/// Upper median of a non-empty list, in O(n).
inline double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Standard deviation about a centre by the median absolute one, of a non-empty list.
inline double deviation_about(double centre, std::vector<double> values) {
  for (double& value : values) value = std::abs(value - centre);
  return kMadToSigma * median_of(std::move(values));
}

}  // namespace odomcalib::calib
