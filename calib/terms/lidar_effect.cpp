#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::terms {

BeamShift LidarEffect::total(const Sighting& sighting, std::span<const double> values) const {
  BeamShift sum;
  const std::vector<BeamShift> units = shifts(sighting);
  for (std::size_t k = 0; k < units.size(); ++k) {
    sum.radial += values[k] * units[k].radial;
    sum.angular += values[k] * units[k].angular;
  }
  return sum;
}

std::vector<std::pair<std::string, Quantity>> LidarEffect::quantities(
    std::span<const double> values, std::span<const double> deviations) const {
  std::vector<std::pair<std::string, Quantity>> out;
  const auto list = parameters();
  for (std::size_t k = 0; k < list.size(); ++k)
    out.push_back({list[k].name, {values[k], deviations[k], list[k].unit}});
  return out;
}

std::vector<LidarEffectPtr> lidar_catalogue(bool all_round) {
  return {make_range_bias(), make_lidar_tilt(), make_angle_scale(all_round)};
}

LidarEffectPtr find_lidar_effect(const std::string& name) {
  for (const auto& effect : lidar_catalogue(false))
    if (effect->name() == name) return effect;
  return nullptr;
}

}  // namespace odomcalib::calib::terms
