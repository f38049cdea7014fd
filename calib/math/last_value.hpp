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
  using Value = std::invoke_result_t<Function&, double>;

  /// @param unread held until the first call: GCC 12 warns of one that is not initialised, as Eigen's are
  explicit LastValue(Function function, Value unread = {})
      : function_(std::move(function)), value_(std::move(unread)) {}

  /// Good until the next call.
  const Value& operator()(double at) {
    if (at != at_) {
      value_ = function_(at);
      at_ = at;
    }
    return value_;
  }

 private:
  Function function_;
  double at_ = std::numeric_limits<double>::quiet_NaN();  // equal to none
  Value value_;
};

}  // namespace odomcalib::calib::math
