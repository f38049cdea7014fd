#include "tests/sim/wires/drawn_robot.hpp"

namespace odomcalib::sim {

DrawnEffect choose_effect(const std::string& name, std::uint64_t seed, double size) {
  Random random(seed);
  if (name == "random") return draw_effect(random);
  const EffectKind* kind = find_effect(name);
  if (kind == nullptr) return {};
  const double used = size >= 0.0 ? size : kind->largest;
  return {kind, used, kind->make(used, random)};
}

SimRobotOptions drawn_robot(std::uint64_t seed, const DrawnEffect& effect) {
  SimRobotOptions options;
  options.seed = seed;
  options.truth = draw_truth(options.nominal, seed);
  options.body.slip_noise = 0.0003;
  if (effect.made) options.disturbances = {effect.made};
  return options;
}

}  // namespace odomcalib::sim
