#include "calib/vehicle/vehicle_model.hpp"

#include <algorithm>

namespace odomcalib::calib::vehicle {

Eigen::Index first_parameter(const EffectList& effects, std::size_t index) {
  Eigen::Index first = kBaseCount;
  for (std::size_t e = 0; e < index; ++e) first += static_cast<Eigen::Index>(effects[e]->parameters().size());
  return first;
}

std::optional<std::size_t> place_of(const EffectList& effects, ClockPart part) {
  const auto place =
      std::find_if(effects.begin(), effects.end(), [&](const auto& e) { return e->clock_part() == part; });
  if (place == effects.end()) return std::nullopt;
  return static_cast<std::size_t>(place - effects.begin());
}

std::optional<Eigen::Index> parameter_of(const EffectList& effects, ClockPart part) {
  const auto place = place_of(effects, part);
  return place ? std::optional(first_parameter(effects, *place)) : std::nullopt;
}

double delay_of(const VehicleModel& model) {
  const auto offset = parameter_of(model.effects, ClockPart::offset);
  return offset ? model.parameters(*offset) : 0.0;
}

VehicleModel first_effects_of(const VehicleModel& model, std::size_t count) {
  const auto end = model.effects.begin() + static_cast<std::ptrdiff_t>(count);
  return {{model.effects.begin(), end}, model.parameters.head(first_parameter(model.effects, count))};
}

}  // namespace odomcalib::calib::vehicle
