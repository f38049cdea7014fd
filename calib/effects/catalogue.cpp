#include "calib/effects/catalogue.hpp"

#include "calib/effects/time_offset.hpp"

namespace odomcalib::calib {

const EffectList& effect_catalogue() {
  static const EffectList kAll = {
      make_time_offset(),
  };
  return kAll;
}

std::shared_ptr<const Effect> find_effect(const std::string& name) {
  for (const auto& effect : effect_catalogue())
    if (effect->name() == name) return effect;
  return nullptr;
}

}  // namespace odomcalib::calib
