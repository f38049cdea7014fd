#include "calib/selection/clocks.hpp"

#include <utility>

#include "calib/selection/criterion.hpp"
#include "calib/selection/settings.hpp"

namespace odomcalib::calib::selection {
namespace {

using vehicle::ClockPart;

Estimate estimate_of(const estimation::FitResult& fit, Eigen::Index parameter) {
  return {fit.parameters(parameter), fit.covariance(parameter, parameter)};
}

bool has_idle(ClockPart part, const vehicle::EffectList& effects, const estimation::FitResult& fit) {
  const auto parameter = parameter_of(effects, part);
  const double negligible = part == ClockPart::offset ? settings::kNegligibleOffset_s : 0.0;
  return parameter && is_idle(estimate_of(fit, *parameter), negligible);
}

/// Any parameter of the effect is many standard deviations from zero.
bool has_plain_value(const FittedModel& model, std::size_t effect) {
  const Eigen::Index end = first_parameter(model.effects, effect + 1);
  for (Eigen::Index k = first_parameter(model.effects, effect); k < end; ++k)
    if (is_plain(estimate_of(model.fit, k))) return true;
  return false;
}

}  // namespace

estimation::Settling settling(bool may_prune, const measurement::Progress& progress) {
  const auto as_it_is = [](const estimation::Fit& fit) { return fit.model; };
  if (!may_prune) return {settings::kNegligibleOffset_s, as_it_is, progress};
  return {settings::kNegligibleOffset_s, without_idle_clocks, progress};
}

vehicle::VehicleModel without_idle_clocks(const estimation::Fit& fit) {
  vehicle::VehicleModel model = fit.model;
  const auto leave_out_last = [&] { model = first_effects_of(model, model.effects.size() - 1); };
  if (has_idle(ClockPart::rate, model.effects, fit.result)) leave_out_last();
  // Clocks that run apart need a delay to run apart from.
  const bool run_apart = place_of(model.effects, ClockPart::rate).has_value();
  if (!run_apart && has_idle(ClockPart::offset, model.effects, fit.result)) leave_out_last();
  return model;
}

SearchResult without_idle_delay(const FitTask& task, SearchResult found) {
  const FittedModel& model = found.model;
  if (found.findings.empty() && found.smooths.empty()) return found;
  if (!has_idle(ClockPart::offset, model.effects, model.fit)) return found;
  const std::size_t place = *place_of(model.effects, ClockPart::offset);
  if (has_plain_value(model, place))
    found.nuisance.push_back(model.effects[place]);
  else if (auto fewer = without_effect(task, model, place, {}))
    found.model = std::move(*fewer);
  return found;
}

}  // namespace odomcalib::calib::selection
