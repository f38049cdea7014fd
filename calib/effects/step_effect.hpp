// Saves every effect that acts on tick intervals from writing its formula twice, for values and for
// derivatives.
#pragma once

#include <cmath>

#include "calib/model/effect.hpp"

namespace odomcalib::calib {

/// A scalar without its derivatives.
inline double plain(double value) { return value; }
inline double plain(const Jet& value) { return value.a; }

/// Derived supplies `template <typename T> void act(const StepContext&, std::span<const T> p,
/// WheelStep<T>&)`, static or const.
template <typename Derived>
class StepEffect : public Effect {
 public:
  void apply(const StepContext& context, std::span<const double> parameters,
             WheelStep<double>& step) const final {
    static_cast<const Derived&>(*this).template act<double>(context, parameters, step);
  }
  void apply(const StepContext& context, std::span<const Jet> parameters, WheelStep<Jet>& step) const final {
    static_cast<const Derived&>(*this).template act<Jet>(context, parameters, step);
  }
};

}  // namespace odomcalib::calib
