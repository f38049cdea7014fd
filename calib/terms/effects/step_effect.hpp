// Saves every effect that acts on tick intervals from writing its formula twice, for values and for
// derivatives.
#pragma once

#include "calib/vehicle/effect.hpp"

namespace odomcalib::calib::terms {

/// A scalar without its derivatives.
inline double plain(double value) { return value; }
inline double plain(const vehicle::Jet& value) { return value.a; }

/// Derived hands the row of the effect to the constructor, and supplies `template <typename T> void act(const
/// StepContext&, std::span<const T> p, WheelStep<T>&)`, static or const.
template <typename Derived>
class StepEffect : public vehicle::Effect {
 public:
  using vehicle::Effect::Effect;

  void apply(const vehicle::StepContext& context, std::span<const double> parameters,
             vehicle::WheelStep<double>& step) const final {
    static_cast<const Derived&>(*this).template act<double>(context, parameters, step);
  }
  void apply(const vehicle::StepContext& context, std::span<const vehicle::Jet> parameters,
             vehicle::WheelStep<vehicle::Jet>& step) const final {
    static_cast<const Derived&>(*this).template act<vehicle::Jet>(context, parameters, step);
  }
};

}  // namespace odomcalib::calib::terms
