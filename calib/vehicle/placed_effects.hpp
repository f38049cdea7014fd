// A list of effects over one parameter vector.
#pragma once

#include <span>
#include <vector>

#include "calib/vehicle/effect.hpp"

namespace odomcalib::calib::vehicle {

/// Effects and where the parameters of each stand in the vector; looked up once, used at every tick.
class PlacedEffects {
 public:
  PlacedEffects() = default;
  /// @param offset of the first effect's parameters
  PlacedEffects(const EffectList& effects, std::size_t offset) : effects_(effects) {
    for (const auto& effect : effects) {
      const std::size_t count = effect->parameters().size();
      places_.push_back({effect.get(), offset, count});
      offset += count;
    }
  }

  template <typename T>
  void apply(const StepContext& context, std::span<const T> parameters, WheelStep<T>& step) const {
    for (const Place& p : places_) p.effect->apply(context, parameters.subspan(p.offset, p.count), step);
  }

  /// Delay of the sensor against the encoders that all effects make together, s.
  /// @param time s, counted from the middle of the recording
  template <typename T>
  T delay(double time, std::span<const T> parameters) const {
    T sum(0.0);
    for (const Place& p : places_) sum += p.effect->delay(time, parameters.subspan(p.offset, p.count));
    return sum;
  }

  [[nodiscard]] const EffectList& list() const { return effects_; }

 private:
  struct Place {
    const Effect* effect;
    std::size_t offset, count;
  };
  EffectList effects_;  ///< keeps them alive
  std::vector<Place> places_;
};

/// Covariates that these effects use together.
inline CovariateGroups covariates_of(const EffectList& effects) {
  CovariateGroups groups;
  for (const auto& effect : effects) groups |= effect->covariates();
  return groups;
}

/// Where a fit of these effects begins.
inline std::vector<double> start_of(const EffectList& effects) {
  std::vector<double> values;
  for (const auto& effect : effects)
    for (const EffectParameter& parameter : effect->parameters()) values.push_back(parameter.start);
  return values;
}

/// Flags of the base parameters, then those of the effects.
inline std::vector<bool> fixed_with(std::vector<bool> base_fixed, const EffectList& effects) {
  for (const auto& effect : effects)
    for (const EffectParameter& parameter : effect->parameters()) base_fixed.push_back(parameter.fixed);
  return base_fixed;
}

}  // namespace odomcalib::calib::vehicle
