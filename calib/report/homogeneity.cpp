#include "calib/report/homogeneity.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

#include "calib/math/pooled_estimates.hpp"
#include "calib/report/settings.hpp"
#include "calib/selection/score.hpp"

namespace odomcalib::calib::report {
namespace {

constexpr Eigen::Index kBase = vehicle::kBaseCount;

/// Effects keep the size that all recordings give them; the clock is each recording's own.
std::vector<bool> fixed_of_one(const selection::FitTask& task, const selection::FittedModel& model) {
  std::vector<bool> fixed = task.fixed(model.effects);
  for (std::size_t e = 0; e < model.effects.size(); ++e) {
    if (model.effects[e]->clock_part() == vehicle::ClockPart::offset) continue;
    const auto first = static_cast<std::size_t>(first_parameter(model.effects, e));
    for (std::size_t k = 0; k < model.effects[e]->parameters().size(); ++k) fixed[first + k] = true;
  }
  return fixed;
}

/// So well that a fit of it alone is as linear as the covariance has it.
bool knows_its_lengths(const OwnEstimate& own) {
  for (const auto k : {vehicle::kLeftRadius, vehicle::kRightRadius, vehicle::kTrackWidth})
    if (!(std::sqrt(own.covariance(k, k)) < settings::kKnownAlone * std::abs(own.value(k)))) return false;
  return own.freedom > 0.0;
}

std::optional<OwnEstimate> own_estimate(const estimation::FitResult& fit, double metre) {
  OwnEstimate own{fit.parameters.head(kBase), fit.covariance.topLeftCorner(kBase, kBase),
                  static_cast<double>(fit.used) - static_cast<double>(kBase)};
  Eigen::VectorXd lengths = own.value;
  lengths(vehicle::kMountYaw) = 0.0;
  for (Eigen::Index k = 0; k < kBase; ++k)
    if (!(own.covariance(k, k) > 0.0)) lengths(k) = 0.0;
  own.covariance += metre * metre * lengths * lengths.transpose();
  return knows_its_lengths(own) ? std::optional(std::move(own)) : std::nullopt;
}

/// Each recording fitted alone; nullopt where that does not settle.
using OwnFits = std::vector<std::optional<estimation::FitResult>>;

/// @param noise of the fits of the recordings alone, to be compared with; empty: estimated
OwnFits own_fits(const selection::FitTask& task, const selection::FittedModel& model, const OwnFits& noise) {
  OwnFits all;
  for (std::size_t i = 0; i < task.data.size(); ++i) {
    estimation::FitOptions options;
    options.fixed = fixed_of_one(task, model);
    if (!noise.empty() && noise[i]) options.noise = noise[i]->noise;
    auto fit = fit_joint(task.data.subspan(i, 1), model.effects, model.fit.parameters, options);
    all.push_back(fit ? std::optional(std::move(fit).value()) : std::nullopt);
  }
  return all;
}

/// The model without its effects; clocks stay.
selection::FittedModel without_effects(const selection::FittedModel& model) {
  selection::FittedModel plain;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < kBase; ++k) kept.push_back(k);
  for (std::size_t e = 0; e < model.effects.size(); ++e) {
    if (model.effects[e]->clock_part() != vehicle::ClockPart::offset) continue;
    plain.effects.push_back(model.effects[e]);
    const auto first = static_cast<Eigen::Index>(first_parameter(model.effects, e));
    for (std::size_t k = 0; k < model.effects[e]->parameters().size(); ++k)
      kept.push_back(first + static_cast<Eigen::Index>(k));
  }
  plain.fit.parameters = model.fit.parameters(kept);
  return plain;
}

/// A change between recordings may have been taken for an effect of what they differ in, such as their speed.
/// Then each of them fits better with lengths of its own alone.
OwnFits fits_of_each(const selection::FitTask& task, const selection::FittedModel& model) {
  OwnFits with = own_fits(task, model, {});
  const selection::FittedModel plain_model = without_effects(model);
  if (plain_model.effects.size() == model.effects.size()) return with;
  OwnFits plain = own_fits(task, plain_model, with);
  double gain = 0.0;
  for (std::size_t i = 0; i < with.size(); ++i)
    if (with[i] && plain[i]) gain += with[i]->cost - plain[i]->cost;
  return gain > price_of_change() ? own_fits(task, plain_model, {}) : with;
}

/// Parameters that are estimated at all.
std::vector<Eigen::Index> free_parameters(const selection::FitTask& task) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k < kBase; ++k)
    if (!task.base_fixed[static_cast<std::size_t>(k)]) free.push_back(k);
  return free;
}

std::vector<math::OwnValues> reduced(const std::vector<std::optional<OwnEstimate>>& own,
                                     const std::vector<Eigen::Index>& free) {
  std::vector<math::OwnValues> all;
  for (std::size_t i = 0; i < own.size(); ++i)
    if (own[i]) all.push_back({i, own[i]->value(free), own[i]->covariance(free, free), own[i]->freedom});
  return all;
}

struct Variance {
  double value = 0.0, freedom = 0.0;
};

/// The same for a difference of two, with its sign (B. L. Welch, Biometrika 34, 1947).
double in_deviations(double apart, const Variance& a, const Variance& b) {
  namespace bm = boost::math;
  const double variance = a.value + b.value;
  const double freedom =
      variance * variance / (a.value * a.value / a.freedom + b.value * b.value / b.freedom);
  const double deviations = apart / std::sqrt(variance);
  const double chance = bm::cdf(bm::complement(bm::students_t(freedom), std::abs(deviations)));
  if (!(chance > 0.0)) return deviations;
  return std::copysign(bm::quantile(bm::complement(bm::normal(), chance)), deviations);
}

/// Estimates that say what is usual: all, without those that are known to be odd.
bool is_usual(const std::optional<OddRecordings>& odd, std::size_t recording) {
  return !odd || !odd->is_decided ||
         std::find(odd->others.begin(), odd->others.end(), recording) != odd->others.end();
}

void compare_with_others(const std::vector<math::OwnValues>& estimates, const std::vector<Eigen::Index>& free,
                         Homogeneity& found) {
  for (const math::OwnValues& one : estimates) {
    math::Pool others(one.value.size());
    double freedom = 0.0;  // of the others
    for (const math::OwnValues& other : estimates) {
      if (other.recording == one.recording || !is_usual(found.odd, other.recording)) continue;
      others.add(other.value, other.covariance);
      freedom += other.freedom;
    }
    const Eigen::VectorXd apart = one.value - others.value();
    const Eigen::VectorXd own_variance = one.covariance.diagonal(),
                          variance_of_others = others.covariance().diagonal();
    for (std::size_t k = 0; k < free.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(one.recording);
      const auto own = static_cast<Eigen::Index>(k);
      found.differences(row, free[k]) = apart(own);
      found.sigmas(row, free[k]) =
          in_deviations(apart(own), {own_variance(own), one.freedom}, {variance_of_others(own), freedom});
    }
  }
}

void name_worst(const std::vector<std::string>& names, Homogeneity& found) {
  constexpr double kAlike = 1e-6;  // of two recordings each is as far from the other
  double most = 0.0;
  for (Eigen::Index i = 0; i < found.sigmas.rows(); ++i)
    for (Eigen::Index k = 0; k < kBase; ++k) {
      const double size = std::abs(found.sigmas(i, k));
      const auto here = static_cast<std::size_t>(i);
      const bool more = size > most * (1.0 + kAlike);
      const bool alike = size > most * (1.0 - kAlike) && names[here] > names[found.recording];
      if (!more && !(alike && size > 0.0)) continue;
      most = std::max(most, size);
      found.recording = here;
      found.parameter = k;
    }
}

/// The joint fit weighs sets of parameters, and may lie beside every value of one alone.
double variance_about(const std::vector<math::OwnValues>& estimates, Eigen::Index parameter, double joint) {
  double weights = 0.0, excess = 0.0;
  for (const math::OwnValues& one : estimates) {
    const double variance = one.covariance(parameter, parameter), apart = one.value(parameter) - joint;
    weights += 1.0 / variance;
    excess += apart * apart / variance - 1.0;
  }
  return std::max(0.0, excess / weights);
}

void name_odd(const std::vector<math::OwnValues>& estimates, const std::vector<Eigen::Index>& free,
              const std::vector<std::string>& names, Homogeneity& found) {
  const auto row = static_cast<Eigen::Index>(found.recording);
  const ParameterChange largest{found.parameter, found.differences(row, found.parameter),
                                found.sigmas(row, found.parameter)};
  found.odd = odd_recordings(estimates, free, names);
  if (found.odd->changes.empty()) found.odd->changes = {largest};
  compare_with_others(estimates, free, found);
  found.recording = found.odd->odd.front();
  found.parameter = found.odd->changes.front().parameter;
}

}  // namespace

std::optional<Homogeneity> homogeneity(const selection::FitTask& task, const selection::FittedModel& model,
                                       double metre, const std::vector<std::string>& names) {
  Homogeneity found;
  for (const auto& fit : fits_of_each(task, model))
    found.own.push_back(fit ? own_estimate(*fit, metre) : std::nullopt);
  const std::vector<Eigen::Index> free = free_parameters(task);
  const std::vector<math::OwnValues> estimates = reduced(found.own, free);
  if (estimates.size() < 2) return std::nullopt;
  const auto recordings = static_cast<Eigen::Index>(task.data.size());
  found.sigmas = found.differences = Eigen::MatrixXd::Zero(recordings, kBase);
  compare_with_others(estimates, free, found);
  name_worst(names, found);
  const auto tests = static_cast<double>(estimates.size() * free.size());
  const double worst = std::abs(found.sigmas(static_cast<Eigen::Index>(found.recording), found.parameter));
  const double of_worst = std::min(1.0, tests * std::erfc(worst / std::sqrt(2.0)));
  const double q = math::cochran(estimates);
  const double of_all =
      std::isfinite(q) ? selection::chi_squared_tail(q, (estimates.size() - 1) * free.size()) : 1.0;
  found.p_value = std::min(1.0, 2.0 * std::min(of_worst, of_all));
  if (found.p_value < settings::kApartLevel) name_odd(estimates, free, names, found);
  found.between = Eigen::VectorXd::Zero(kBase);
  for (std::size_t k = 0; k < free.size(); ++k) {
    const auto parameter = static_cast<Eigen::Index>(k);
    found.between(free[k]) = std::max(math::variance_between(estimates, parameter),
                                      variance_about(estimates, parameter, model.fit.parameters(free[k])));
  }
  return found;
}

}  // namespace odomcalib::calib::report
