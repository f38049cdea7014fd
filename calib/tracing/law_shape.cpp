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

std::optional<FinerCurve> refined(const FitTask& task, const FittedModel& model, const Curve& curve) {
  const auto models = task.models();
  const auto finer = refined(curve, models);
  if (!finer) return std::nullopt;
  EffectList effects = model.effects;
  effects.back() = make_curve_effect(*finer);
  const Eigen::Index kept = first_parameter(effects, effects.size() - 1);
  Eigen::VectorXd start = Eigen::VectorXd::Zero(kept + static_cast<Eigen::Index>(basis_size(*finer)));
  start.head(kept) = model.fit.parameters.head(kept);
  auto fit = task.fit(effects, start, model.fit.noise);
  if (!fit || spoils_base(*effects.back(), model.fit, *fit)) return std::nullopt;
  return FinerCurve{*finer, {std::move(effects), std::move(*fit)}};
}

bool is_better(const FitTask& task, const FittedModel& coarse, const FittedModel& fine) {
  const auto more = static_cast<double>(fine.fit.parameters.size() - coarse.fit.parameters.size());
  const double penalty = more * std::log(static_cast<double>(coarse.fit.whitened_residual.size()));
  return coarse.fit.cost - fine.fit.cost > penalty &&
         compared_on_held_out(task, coarse, fine, all_folds()).total > 0.0;
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
