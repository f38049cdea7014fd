// The median, and the spread that goes with it: what outliers cannot move; what it is often taken of.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace odomcalib::calib::math {

/// Median absolute deviation times this is the standard deviation of normally distributed values.
inline constexpr double kMadToSigma = 1.4826;

/// Upper median of a non-empty list, in O(n).
inline double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Differences of neighbours: one fewer than values.
inline std::vector<double> differences_of(const std::vector<double>& values) {
  std::vector<double> differences;
  for (std::size_t k = 1; k < values.size(); ++k) differences.push_back(values[k] - values[k - 1]);
  return differences;
}

/// Standard deviation about a centre by the median absolute one, of a non-empty list.
inline double deviation_about(double centre, std::vector<double> values) {
  for (double& value : values) value = std::abs(value - centre);
  return kMadToSigma * median_of(std::move(values));
}

}  // namespace odomcalib::calib::math
