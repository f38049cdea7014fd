// The functions that curves are sums of.
#pragma once

#include <algorithm>
#include <array>
#include <initializer_list>
#include <span>

#include "calib/terms/curve.hpp"

namespace odomcalib::calib::terms {

/// A curve's functions' values. They are asked for each tick interval of each fit, so they stay off the
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
  std::array<double, kMostKnots + 3> values_;  // NOLINT(*-member-init): the first `count_` are set
  std::size_t count_ = 0;
};

/// The carriers that a curve acts on: its own, or, of a variable that each wheel has for itself, the travel
/// of the left and of the right wheel with the same coefficients, or, of an event, with one for each; of a
/// sensor that was moved, its three.
std::span<const vehicle::Carrier> acts_on(const Curve& curve);
/// Whether the function is one of that carrier's; otherwise it is zero there.
bool belongs_to(const Curve& curve, std::size_t function, std::size_t part);

/// @param part index of the carrier among those it acts on
BasisValues basis(const Curve& curve, const vehicle::StepContext& context, std::size_t part = 0);
std::size_t basis_size(const Curve& curve);

/// What the coefficients are multiplied by in an interval: the basis, or on the sensor's yaw its growth.
BasisValues functions_in(const Curve& curve, const vehicle::StepContext& context, std::size_t part = 0);

}  // namespace odomcalib::calib::terms
