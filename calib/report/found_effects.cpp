#include "calib/report/found_effects.hpp"

#include <algorithm>
#include <cmath>

#include "calib/selection/file_entries.hpp"
#include "calib/selection/settings.hpp"
#include "calib/terms/smooth_term.hpp"
#include "calib/validation/folds.hpp"
#include "calib/validation/window_errors.hpp"

namespace odomcalib::calib::report {
namespace {

using EffectPtr = std::shared_ptr<const vehicle::Effect>;

const selection::Finding* finding_of(const selection::SearchResult& outcome, const EffectPtr& effect) {
  for (const selection::Finding& finding : outcome.findings)
    if (finding.effect == effect) return &finding;
  return nullptr;
}

const selection::AddedSmoothTerm* smooth_of(const selection::SearchResult& outcome, const EffectPtr& effect) {
  for (const selection::AddedSmoothTerm& added : outcome.smooths)
    if (added.effect == effect) return &added;
  return nullptr;
}

bool is_nuisance(const selection::SearchResult& outcome, const EffectPtr& effect) {
  return std::find(outcome.nuisance.begin(), outcome.nuisance.end(), effect) != outcome.nuisance.end();
}

/// Evidence for an effect that the search did not add: the delay found before it, or what the user requested.
/// @param z standard deviations from zero
Evidence evidence_against(const std::optional<estimation::FitResult>& plain, const Findings& found,
                          double z) {
  Evidence evidence;
  evidence.p_value = std::erfc(z / std::sqrt(2.0));
  if (!plain) return evidence;
  const measurement::Dataset& dataset = found.fit.dataset;
  const auto& [effects, fit] = found.outcome.model;
  const auto windows = validation::find_windows(validation::WindowKind::open_loop, dataset.data,
                                                validation::folds_of(dataset.data), fit,
                                                validation::trusted_pairs(*plain, fit));
  if (windows.size() < selection::settings::kFewestWindows) return evidence;
  evidence.held_out_before =
      validation::window_errors(dataset.data, windows, {}, *plain, dataset.fixed()).rms_position();
  evidence.held_out_after = validation::window_errors(dataset.data, windows, effects, fit,
                                                      vehicle::fixed_with(dataset.fixed(), effects))
                                .rms_position();
  return evidence;
}

/// Name and values.
/// @param first parameter of the effect in the parameter vector
EffectResult values_of(const vehicle::Effect& effect, Eigen::Index first, const estimation::FitResult& fit) {
  EffectResult result;
  result.name = effect.name();
  for (const vehicle::EffectParameter& parameter : effect.parameters()) {
    const double deviation = std::sqrt(std::max(fit.covariance(first, first), 0.0));
    // A parameter that the data do not speak of has no deviation, rather than one of zero.
    const bool is_estimated = !parameter.fixed && deviation > 0.0;
    result.parameters.push_back(
        {parameter.name, {fit.parameters(first), is_estimated ? deviation : -1.0, parameter.unit}});
    ++first;
  }
  return result;
}

/// Standard deviations from zero of the size that is plainest.
double plainest_size(const vehicle::Effect& effect, Eigen::Index first, const estimation::FitResult& fit) {
  double z = 0.0;
  for (const vehicle::EffectParameter& parameter : effect.parameters()) {
    const double deviation = std::sqrt(std::max(fit.covariance(first, first), 0.0));
    if (deviation > 0.0 && parameter.start == 0.0)
      z = std::max(z, std::abs(fit.parameters(first)) / deviation);
    ++first;
  }
  return z;
}

EffectResult found_effect(const EffectPtr& effect, Eigen::Index first, const Findings& found,
                          const std::optional<estimation::FitResult>& plain) {
  const estimation::FitResult& fit = found.outcome.model.fit;
  EffectResult result = values_of(*effect, first, fit);
  if (const selection::Finding* finding = finding_of(found.outcome, effect)) {
    result.aliases = finding->aliases;
    result.evidence = {finding->validation.family_p_value, finding->validation.before,
                       finding->validation.after};
  } else {
    result.aliases = effect->observationally_equivalent();
    result.evidence = evidence_against(plain, found, plainest_size(*effect, first, fit));
  }
  return result;
}

terms::FittedSmoothTerm fitted(const selection::AddedSmoothTerm& added, Eigen::Index first,
                               const estimation::FitResult& fit) {
  terms::FittedSmoothTerm smooth{added.smooth, {}, added.named_term ? added.named_term->name() : ""};
  for (std::size_t k = 0; k < function_count(added.smooth); ++k)
    smooth.coefficients.push_back(fit.parameters(first++));
  return smooth;
}

/// Summary of what stays without a name, put together from its parts.
class UnnamedSummary {
 public:
  void mention(const std::string& covariate) {
    auto& names = all_.depends_on;
    if (std::find(names.begin(), names.end(), covariate) == names.end()) names.push_back(covariate);
  }
  void add(const std::string& covariate, double p_value, double before, double after) {
    if (all_.depends_on.empty()) all_.p_value = p_value;
    mention(covariate);
    const double ratio = before > 0.0 ? after / before : 1.0;
    left_ *= std::min(ratio * ratio, 1.0);
  }
  [[nodiscard]] std::optional<Unexplained> result() const {
    if (all_.depends_on.empty()) return std::nullopt;
    Unexplained out = all_;
    out.share = 1.0 - left_;
    return out;
  }

 private:
  Unexplained all_;
  double left_ = 1.0;  // of the squared error
};

/// Unexplained error that goes with covariates, but is no part of the model.
std::optional<Unexplained> flagged(const std::vector<vehicle::Covariate>& covariates, double p_value) {
  if (covariates.empty()) return std::nullopt;
  Unexplained unexplained{{}, p_value, 0.0};
  for (const vehicle::Covariate covariate : covariates)
    unexplained.depends_on.push_back(to_string(covariate));
  return unexplained;
}

}  // namespace

std::vector<EffectResult> found_effects(const Findings& found,
                                        const std::optional<estimation::FitResult>& plain) {
  std::vector<EffectResult> results = selection::effect_results(found.lidar);
  if (found.was_searched)
    for (EffectResult& effect : effects_of(found.fit.dataset.recordings.stamps()))
      results.push_back(std::move(effect));
  const vehicle::EffectList& effects = found.outcome.model.effects;
  for (std::size_t e = 0; e < effects.size(); ++e)
    if (smooth_of(found.outcome, effects[e]) == nullptr && !is_nuisance(found.outcome, effects[e]))
      results.push_back(found_effect(effects[e], first_parameter(effects, e), found, plain));
  return results;
}

std::vector<terms::FittedSmoothTerm> found_smooths(const Findings& found) {
  std::vector<terms::FittedSmoothTerm> smooths;
  const auto& [effects, fit] = found.outcome.model;
  for (std::size_t e = 0; e < effects.size(); ++e)
    if (const selection::AddedSmoothTerm* added = smooth_of(found.outcome, effects[e]))
      smooths.push_back(fitted(*added, first_parameter(effects, e), fit));
  return smooths;
}

std::optional<Unexplained> unnamed_smooths(const Findings& found) {
  UnnamedSummary summary;
  for (const terms::LidarFinding& finding : found.lidar)
    if (!finding.effect->is_named() && !completes(finding, found.lidar))
      summary.add(finding.effect->name(), finding.family_p_value, finding.before, finding.after);
  for (const selection::AddedSmoothTerm& added : found.outcome.smooths)
    if (!added.named_term)
      summary.add(to_string(added.smooth.dependence.covariate), added.validation.family_p_value,
                  added.validation.before, added.validation.after);
  for (const selection::AddedSmoothTerm& added : found.outcome.smooths) {
    if (added.named_term) continue;
    for (const vehicle::Covariate covariate : added.alike) summary.mention(to_string(covariate));
  }
  return summary.result();
}

std::optional<Unexplained> flagged_outliers(const report::OutlierTrace& outliers) {
  return flagged(outliers.depends_on, outliers.p_value);
}

std::optional<Unexplained> failed_validation(const selection::SearchResult& outcome) {
  const selection::Considered* best = nullptr;
  for (const selection::Considered& one : outcome.considered)
    if (!one.depends_on.empty() && one.family_p_value <= selection::settings::kNamedLevel &&
        (best == nullptr || one.statistic > best->statistic))
      best = &one;
  return best == nullptr ? std::nullopt : flagged(best->depends_on, best->family_p_value);
}

}  // namespace odomcalib::calib::report
