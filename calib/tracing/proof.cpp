#include "calib/tracing/proof.hpp"

#include <algorithm>

namespace odomcalib::calib {

HeldOutGain compared_on_held_out(const FitTask& task, const FittedModel& before, const FittedModel& after,
                                 const FoldFlags& selected) {
  std::vector<double> weights(after.fit.weights.size());
  std::transform(after.fit.weights.begin(), after.fit.weights.end(), before.fit.weights.begin(),
                 weights.begin(), [](double a, double b) { return std::max(a, b); });
  return held_out_gain(task.data, with_weights(task.data, before.effects, before.fit, weights),
                       task.fixed(before.effects), with_weights(task.data, after.effects, after.fit, weights),
                       task.fixed(after.effects), selected);
}

std::string objection(const FitTask& task, const FittedModel& before, const FittedModel& after,
                      const FoldFlags& selected, double largest_ratio, Proof& proof) {
  const std::vector<bool> trusted = trusted_pairs(before.fit, after.fit);
  const auto error_of = [&](const FittedModel& model) {
    return horizon_error(task.data, model.effects, model.fit, task.fixed(model.effects), trusted);
  };
  const auto without = error_of(before), with = error_of(after);
  if (without && with) {
    const HorizonError mixed = where_selected(*without, *with, selected);
    proof.before = without->rms_position();
    proof.after = mixed.rms_position();
    proof.improvement = compare(*without, mixed);
    if (proof.improvement.ratio > largest_ratio)
      return "too small a gain: error times " + std::to_string(proof.improvement.ratio).substr(0, 5);
    if (proof.improvement.upper < 1.0) return {};
    if (proof.improvement.lower > 1.0) return "held-out error rises";
  }
  return compared_on_held_out(task, before, after, selected).lower > 0.0 ? "" : "no gain on held-out data";
}

}  // namespace odomcalib::calib
