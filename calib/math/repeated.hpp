// Mean of a few repetitions of one measurement.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>

namespace odomcalib::calib::math {

struct Repeated {
  double mean = 0.0;
  double spread = 0.0;  ///< standard deviation of one repetition
  double std = -1.0;    ///< of the mean; two of them hold 95 %, however few repetitions there are. < 0: one
                        ///< repetition shows no spread
  std::size_t count = 0;
};

/// 97.5 % quantile of Student's t distribution over that of the normal one: the spread of a few repetitions
/// is itself uncertain.
/// @param freedom repetitions - 1, at least 1
inline double student_factor(std::size_t freedom) {
  constexpr double kNormal = 1.959964;
  constexpr std::array<double, 10> kQuantiles = {12.7062, 4.3027, 3.1824, 2.7764, 2.5706,
                                                 2.4469,  2.3646, 2.3060, 2.2622, 2.2281};
  if (freedom <= kQuantiles.size()) return kQuantiles.at(freedom - 1) / kNormal;
  // Fisher's expansion in 1 / freedom, good to 1e-4 here (Abramowitz and Stegun 26.7.5).
  const double n = static_cast<double>(freedom);
  const double cube = kNormal * kNormal * kNormal;
  const double first = (cube + kNormal) / 4.0;
  const double second = (5.0 * cube * kNormal * kNormal + 16.0 * cube + 3.0 * kNormal) / 96.0;
  return (kNormal + first / n + second / (n * n)) / kNormal;
}

inline Repeated repeated(std::span<const double> values) {
  Repeated result;
  result.count = values.size();
  if (values.empty()) return result;
  const double n = static_cast<double>(values.size());
  result.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  if (values.size() < 2) return result;
  double squares = 0.0;
  for (const double value : values) squares += (value - result.mean) * (value - result.mean);
  result.spread = std::sqrt(squares / (n - 1.0));
  result.std = student_factor(values.size() - 1) * result.spread / std::sqrt(n);
  return result;
}

}  // namespace odomcalib::calib::math
