#include "tests/sim/effects/effect.hpp"

#include <cmath>
#include <numbers>

namespace odomcalib::sim {

namespace {

std::vector<EffectKind> gather() {
  std::vector<EffectKind> all;
  for (auto* family :
       {wheel_effects, drive_train_effects, contact_effects, floor_effects, time_effects, lidar_effects})
    for (EffectKind& kind : family()) all.push_back(std::move(kind));
  return all;
}

}  // namespace

const std::vector<EffectKind>& effect_kinds() {
  static const std::vector<EffectKind> kinds = gather();
  return kinds;
}

const EffectKind* find_effect(const std::string& name) {
  for (const auto* kinds : {&effect_kinds(), &free_laws()})
    for (const EffectKind& kind : *kinds)
      if (kind.name == name) return &kind;
  return nullptr;
}

DrawnEffect draw_effect(Random& random, double size_factor) {
  DrawnEffect drawn;
  drawn.kind = &effect_kinds()[random() % effect_kinds().size()];
  drawn.size =
      size_factor * std::exp(uniform(random, std::log(drawn.kind->smallest), std::log(drawn.kind->largest)));
  drawn.made = drawn.kind->make(drawn.size, random);
  return drawn;
}

std::size_t any_side(Random& random) { return random() % 2 == 0 ? kLeft : kRight; }

double any_angle(Random& random) { return uniform(random, -std::numbers::pi, std::numbers::pi); }

double any_sign(Random& random) { return random() % 2 == 0 ? 1.0 : -1.0; }

}  // namespace odomcalib::sim
