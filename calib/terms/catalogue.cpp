#include "calib/terms/catalogue.hpp"

#include <algorithm>

namespace odomcalib::calib::terms {
namespace {

constexpr auto kMeaningAmong = [](const auto& catalogue, std::string_view effect,
                                  std::string_view parameter) -> const ParameterMeaning* {
  for (const auto& one : catalogue)
    for (const auto& own : one->parameters())
      if (one->name() == effect && own.name == parameter) return &own.meaning;
  return nullptr;
};

}  // namespace

using EffectPtr = std::shared_ptr<const vehicle::Effect>;

// Makers of the effects, each in the file of its name in effects/; those that other code asks for are
// declared in the header.
EffectPtr make_time_offset();
EffectPtr make_clock_drift();
EffectPtr make_encoder_lag();
EffectPtr make_wheel_eccentricity_left();
EffectPtr make_wheel_eccentricity_right();
EffectPtr make_tick_loss();
EffectPtr make_backlash();
EffectPtr make_direction_dependent_diameter();
EffectPtr make_speed_dependent_radius();
EffectPtr make_acceleration_slip();
EffectPtr make_lateral_slip();
EffectPtr make_speed_dependent_track();
EffectPtr make_track_depends_on_motion();
EffectPtr make_turn_direction_asymmetry();
EffectPtr make_caster_kick();
EffectPtr make_stop_settling();
EffectPtr make_drift_with_time();
EffectPtr make_floor_slope();
EffectPtr make_carpet();
LidarEffectPtr make_lidar_tilt();

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

const std::vector<LidarEffectPtr>& lidar_catalogue(bool all_round) {
  static const auto kAll = [](bool sees_all_round) {
    return std::vector<LidarEffectPtr>{make_range_bias(), make_lidar_tilt(),
                                       make_angle_scale(sees_all_round)};
  };
  static const std::vector<LidarEffectPtr> kAllRound = kAll(true), kOfAView = kAll(false);
  return all_round ? kAllRound : kOfAView;
}

LidarEffectPtr find_lidar_effect(const std::string& name) {
  for (const auto& effect : lidar_catalogue(false))
    if (effect->name() == name) return effect;
  return nullptr;
}

const ParameterMeaning* meaning_of(std::string_view effect, std::string_view parameter) {
  const ParameterMeaning* of_wheels = kMeaningAmong(effect_catalogue(), effect, parameter);
  return of_wheels ? of_wheels : kMeaningAmong(lidar_catalogue(false), effect, parameter);
}

std::optional<std::string> unit_of_effect(const std::string& effect, const std::string& parameter) {
  for (const auto& of_wheels : find_effects(effect))
    for (const vehicle::EffectParameter& own : of_wheels->parameters())
      if (own.name == parameter) return own.unit;
  if (const LidarEffectPtr of_lidar = find_lidar_effect(effect))
    for (const LidarParameter& own : of_lidar->parameters())
      if (own.name == parameter) return own.unit;
  return std::nullopt;
}

}  // namespace odomcalib::calib::terms
