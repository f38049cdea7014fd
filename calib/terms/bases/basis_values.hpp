// The values of a basis' functions, kept off the heap.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>

namespace odomcalib::calib::terms {

/// The most functions that a basis may have.
inline constexpr std::size_t kMostFunctions = 27;

/// A basis' functions' values. They are computed for each tick interval of each fit, so they stay off the
/// heap.
class BasisValues {
 public:
  BasisValues() = default;
  /// All zero.
  explicit BasisValues(std::size_t count) : count_(count) { std::fill_n(values_.begin(), count, 0.0); }
  BasisValues(std::initializer_list<double> values) {
    for (const double value : values) push_back(value);
  }
  void push_back(double value) { values_[count_++] = value; }
  [[nodiscard]] std::size_t size() const { return count_; }
  double& operator[](std::size_t k) { return values_[k]; }
  double operator[](std::size_t k) const { return values_[k]; }
  [[nodiscard]] const double* begin() const { return values_.data(); }
  [[nodiscard]] const double* end() const { return values_.data() + count_; }

 private:
  std::array<double, kMostFunctions> values_;  // NOLINT(*-member-init): the first `count_` are set
  std::size_t count_ = 0;
};

/// Hat functions about knots: 1 at the knot, 0 from its neighbours on.
inline double hat(double steps) { return std::max(0.0, 1.0 - (steps < 0.0 ? -steps : steps)); }

}  // namespace odomcalib::calib::terms
