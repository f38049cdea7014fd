// A function that is asked for the same argument twice in a row.
#pragma once

#include <limits>
#include <type_traits>
#include <utility>

namespace odomcalib::calib::math {

/// Computes a value once where one motion begins when the one before ends.
template <typename Function>
class LastValue {
 public:
  explicit LastValue(Function function) : function_(std::move(function)) {}

  /// Good until the next call.
  const auto& operator()(double at) {
    if (at != at_) {
      value_ = function_(at);
      at_ = at;
    }
    return value_;
  }

 private:
  Function function_;
  double at_ = std::numeric_limits<double>::quiet_NaN();  // equal to none
  std::invoke_result_t<Function&, double> value_{};
};

}  // namespace odomcalib::calib::math
