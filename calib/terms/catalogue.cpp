#include "calib/terms/catalogue.hpp"

#include <algorithm>

#include "calib/terms/effects/factories.hpp"

namespace odomcalib::calib::terms {

const vehicle::EffectList& effect_catalogue() {
  static const vehicle::EffectList kAll = {
      make_time_offset(),
      make_clock_drift(),
      make_encoder_lag(),
      make_scan_skew(),
      make_wheel_eccentricity_left(),
      make_wheel_eccentricity_right(),
      make_tick_loss(),
      make_backlash(),
      make_direction_dependent_diameter(),
      make_speed_dependent_radius(),
      make_acceleration_slip(),
      make_lateral_slip(),
      make_speed_dependent_track(),
      make_track_depends_on_motion(),
      make_turn_direction_asymmetry(),
      make_caster_kick(),
      make_stop_settling(),
      make_drift_with_time(),
      make_floor_slope(),
      make_carpet(),
  };
  return kAll;
}

std::shared_ptr<const vehicle::Effect> find_effect(const std::string& name,
                                                   const std::string& first_parameter) {
  for (const auto& effect : effect_catalogue())
    if (effect->name() == name &&
        (first_parameter.empty() || effect->parameters().front().name == first_parameter))
      return effect;
  return nullptr;
}

std::shared_ptr<const vehicle::Effect> clock_effect(vehicle::ClockPart part) {
  for (const auto& effect : effect_catalogue())
    if (effect->clock_part() == part) return effect;
  return nullptr;
}

vehicle::EffectList find_effects(const std::string& name) {
  vehicle::EffectList found;
  std::copy_if(effect_catalogue().begin(), effect_catalogue().end(), std::back_inserter(found),
               [&](const auto& effect) { return effect->name() == name; });
  return found;
}

}  // namespace odomcalib::calib::terms
