#include "calib/stages/fit_stages.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/ingest/sweeps.hpp"
#include "calib/math/se2.hpp"
#include "calib/measurement/scan_stamps.hpp"
#include "calib/stages/settings.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/validation/criterion.hpp"

namespace odomcalib::calib::stages {
namespace {

/// The recordings of the fit with even stamps where the motion is that of even times; nothing where all
/// stamps are right.
std::optional<ingest::Recordings> with_even_scans(const estimation::Fit& fit) {
  const ingest::Recordings& given = fit.dataset.recordings;
  ingest::Repairs repairs(given.view());
  ingest::StampReport stamps = given.stamps();
  for (std::size_t i = 0; i < given.size(); ++i) {
    const auto even = even_scans(given[i], fit.dataset.data[i], fit.model.effects, fit.model.parameters);
    if (!even) continue;
    set_stamps(repairs.own(i).scans, even->t);
    stamps.scans = std::max(stamps.scans, even->jitter);
  }
  if (!repairs.any()) return std::nullopt;
  return std::move(repairs).take(stamps);
}

/// A delay that is fitted anyway is counted from the middle of a sweep.
estimation::Fit fit_to_sweeps(measurement::Dataset sweeping, const terms::Request& request,
                              const estimation::Settling& how) {
  estimation::Fit fit = fit_anew(std::move(sweeping), request, how);
  if (fit.failure || !place_of(fit.model.effects, vehicle::ClockPart::offset)) return fit;
  const ingest::Recordings moved = ingest::stamped_in_the_middle(fit.dataset.recordings);
  return measure_and_settle(with_scans_of(std::move(fit.dataset), moved), std::move(fit.model), how);
}

validation::Estimate estimate_of(const estimation::FitResult& fit, Eigen::Index parameter) {
  return {fit.parameters(parameter), fit.covariance(parameter, parameter)};
}

validation::MountingOffset mounting_offset_of(const estimation::FitResult& fit) {
  return {estimate_of(fit, vehicle::kMountX), estimate_of(fit, vehicle::kMountY),
          estimate_of(fit, vehicle::kMountYaw)};
}

measurement::Dataset mounted(measurement::Dataset dataset, bool anywhere) {
  dataset.reference_sits_anywhere = anywhere;
  return dataset;
}

using vehicle::ClockPart;

bool has_idle(ClockPart part, const vehicle::EffectList& effects, const estimation::FitResult& fit) {
  const auto parameter = parameter_of(effects, part);
  const double negligible = part == ClockPart::offset ? settings::kNegligibleOffset_s : 0.0;
  return parameter && validation::is_idle(estimate_of(fit, *parameter), negligible);
}

/// Any parameter of the effect is many standard deviations from zero.
bool has_plain_value(const selection::FittedModel& model, std::size_t effect) {
  const Eigen::Index end = first_parameter(model.effects, effect + 1);
  for (Eigen::Index k = first_parameter(model.effects, effect); k < end; ++k)
    if (validation::is_plain(estimate_of(model.fit, k))) return true;
  return false;
}

/// Time of a turn of the head beyond the one that the fit has, s, as bent scans show it; 0 where they are
/// not.
double turn_beyond(const estimation::Fit& fit) {
  vehicle::VehicleModel bent = fit.model;
  bent.effects.push_back(terms::make_scan_skew());
  bent.parameters.conservativeResizeLike(Eigen::VectorXd::Zero(bent.parameters.size() + 1));
  const estimation::Fit skewed = estimation::fit_once(fit.dataset, bent);
  if (skewed.failure) return 0.0;
  const validation::Estimate skew = estimate_of(skewed.result, bent.parameters.size() - 1);
  return validation::is_plain(skew) ? 2.0 * math::kPi * skew.value : 0.0;
}

/// The fit to the sweeps, if it is clearly better on data that it was not fitted to.
std::optional<estimation::Fit> if_better(const estimation::Fit& fit, estimation::Fit swept) {
  const auto before = validation::held_out_residual(fit), after = validation::held_out_residual(swept);
  if (!validation::is_clearly_better(before, after)) return std::nullopt;
  ingest::StampReport stamps = swept.dataset.recordings.stamps();
  stamps.sweep_p_value = validation::p_value_of(*before, *after);
  swept.dataset.recordings = swept.dataset.recordings.reported_as(stamps);
  return swept;
}

}  // namespace

estimation::Fit choose_scan_stamps(estimation::Fit fit, const estimation::Settling& how) {
  if (fit.failure || !fit.dataset.reference_is_scans()) return fit;
  const auto even = with_even_scans(fit);
  if (!even) return fit;
  return measure_and_settle(with_scans_of(std::move(fit.dataset), *even), std::move(fit.model), how);
}

estimation::Fit choose_sweep_timing(estimation::Fit fit, const terms::Request& request,
                                    const estimation::Settling& how) {
  if (fit.failure || !fit.dataset.reference_is_scans()) return fit;
  using ingest::SweepKind;
  const auto sweeping = ingest::with_sweeps(fit.dataset.recordings);
  if (sweeping)
    if (auto better = if_better(fit, fit_to_sweeps(with_scans_of(fit.dataset, *sweeping), request, how)))
      return std::move(*better);
  const double beyond = turn_beyond(fit);
  if (beyond == 0.0) return fit;
  for (const SweepKind kind : {SweepKind::against_the_list, SweepKind::instead_of_stated}) {
    const auto other = ingest::with_sweeps(fit.dataset.recordings, kind);
    // The turn that scans show is nearer to that of this head than to none, or to twice as much.
    if (!other || !(2.0 * std::abs(beyond - other->stamps().turn) < std::abs(other->stamps().turn))) continue;
    measurement::Dataset turned = with_scans_of(fit.dataset, *other);
    auto better = if_better(fit, sweeping ? fit_to_sweeps(std::move(turned), request, how)
                                          : fit_anew(std::move(turned), request, how));
    if (better) return std::move(*better);
  }
  return fit;
}

estimation::Fit mount_reference(estimation::Fit fit, const estimation::Settling& how) {
  if (fit.failure || !fit.dataset.reference_is_base()) return fit;
  estimation::Fit elsewhere = settle(mounted(fit.dataset, true), fit.model, how);
  if (!elsewhere.failure && validation::is_mounted_elsewhere(mounting_offset_of(elsewhere.result)))
    return elsewhere;
  // Settled once more on the trial's pairs, instead of keeping the fit as it was: it has one more pass behind
  // it then, as every result so far has had, and differs in the last digits.
  return settle(mounted(std::move(elsewhere.dataset), false), std::move(fit.model), how);
}

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

selection::SearchResult without_idle_delay(const selection::FitTask& task, selection::SearchResult found) {
  const selection::FittedModel& model = found.model;
  if (found.findings.empty() && found.smooths.empty()) return found;
  if (!has_idle(ClockPart::offset, model.effects, model.fit)) return found;
  const std::size_t place = *place_of(model.effects, ClockPart::offset);
  if (has_plain_value(model, place))
    found.nuisance.push_back(model.effects[place]);
  else if (auto fewer = selection::without_effect(task, model, place, {}))
    found.model = std::move(*fewer);
  return found;
}

}  // namespace odomcalib::calib::stages
