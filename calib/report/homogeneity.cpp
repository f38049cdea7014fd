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

std::optional<OwnEstimate> own_estimate(const selection::FitTask& task, const selection::FittedModel& model,
                                        std::size_t recording, double metre) {
  estimation::FitOptions options;
  options.fixed = fixed_of_one(task, model);
  const auto fit = fit_joint(task.data.subspan(recording, 1), model.effects, model.fit.parameters, options);
  if (!fit) return std::nullopt;
  OwnEstimate own{fit.value().parameters.head(kBase), fit.value().covariance.topLeftCorner(kBase, kBase),
                  static_cast<double>(fit.value().used) - static_cast<double>(kBase)};
  Eigen::VectorXd lengths = own.value;
  lengths(vehicle::kMountYaw) = 0.0;
  for (Eigen::Index k = 0; k < kBase; ++k)
    if (!(own.covariance(k, k) > 0.0)) lengths(k) = 0.0;
  own.covariance += metre * metre * lengths * lengths.transpose();
  return knows_its_lengths(own) ? std::optional(std::move(own)) : std::nullopt;
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

void compare_with_others(const std::vector<math::OwnValues>& estimates, const std::vector<Eigen::Index>& free,
                         Homogeneity& found) {
  for (const math::OwnValues& one : estimates) {
    math::Pool others(one.value.size());
    double freedom = 0.0;  // of the others
    for (const math::OwnValues& other : estimates) {
      if (other.recording == one.recording) continue;
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

}  // namespace

std::optional<Homogeneity> homogeneity(const selection::FitTask& task, const selection::FittedModel& model,
                                       double metre, const std::vector<std::string>& names) {
  Homogeneity found;
  for (std::size_t i = 0; i < task.data.size(); ++i) found.own.push_back(own_estimate(task, model, i, metre));
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
  found.between = Eigen::VectorXd::Zero(kBase);
  for (std::size_t k = 0; k < free.size(); ++k)
    found.between(free[k]) = math::variance_between(estimates, static_cast<Eigen::Index>(k));
  return found;
}

}  // namespace odomcalib::calib::report
