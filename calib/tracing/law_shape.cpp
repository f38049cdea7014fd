#include "calib/tracing/law_shape.hpp"

#include <cmath>

#include "calib/tracing/plausibility.hpp"
#include "calib/tracing/proof.hpp"

namespace odomcalib::calib {
namespace {

/// Base parameters that the carrier scales.
std::vector<BaseIndex> lengths_of(Carrier carrier) {
  switch (carrier) {
    case Carrier::left_travel:
      return {kLeftRadius};
    case Carrier::right_travel:
      return {kRightRadius};
    case Carrier::both_travel:
      return {kLeftRadius, kRightRadius};
    case Carrier::track:
      return {kTrackWidth};
    default:
      return {};
  }
}

FoldFlags all_folds() {
  FoldFlags flags;
  flags.fill(true);
  return flags;
}

}  // namespace

std::vector<Reshaped> reshaped(const FitTask& task, const FittedModel& model, const Curve& curve) {
  std::vector<Reshaped> all;
  const auto models = task.models();
  const Eigen::Index kept = first_parameter(model.effects, model.effects.size() - 1);
  for (const Curve& shape : other_shapes(curve, models)) {
    EffectList effects = model.effects;
    effects.back() = make_curve_effect(shape);
    Eigen::VectorXd start = Eigen::VectorXd::Zero(kept + static_cast<Eigen::Index>(basis_size(shape)));
    start.head(kept) = model.fit.parameters.head(kept);
    auto fit = task.fit(effects, start, model.fit.noise);
    if (!fit || spoils_base(*effects.back(), model.fit, *fit)) continue;
    all.push_back({shape, {std::move(effects), std::move(*fit)}});
  }
  return all;
}

bool is_better(const FitTask& task, const FittedModel& given, const FittedModel& other) {
  const auto more = static_cast<double>(other.fit.parameters.size() - given.fit.parameters.size());
  const double penalty = more * std::log(static_cast<double>(given.fit.whitened_residual.size()));
  return given.fit.cost - other.fit.cost > penalty &&
         compared_on_held_out(task, given, other, all_folds()).total > 0.0;
}

Eigen::VectorXd doubt_of_zero(const FitTask& task, const FittedModel& model, const Curve& curve) {
  Eigen::VectorXd doubt = Eigen::VectorXd::Zero(kBaseCount);
  if (curve.mean.empty()) return doubt;
  const Eigen::VectorXd own = model.fit.parameters.tail(static_cast<Eigen::Index>(basis_size(curve)));
  const double spread = spread_of(curve, as_span(own), task.models());
  for (const auto k : lengths_of(curve.law.carrier)) doubt(k) = spread * model.fit.parameters(k);
  return doubt;
}

}  // namespace odomcalib::calib
