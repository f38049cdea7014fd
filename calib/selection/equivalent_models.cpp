#include "calib/selection/equivalent_models.hpp"

#include <algorithm>

#include "calib/selection/settings.hpp"

namespace odomcalib::calib::selection {
namespace {

template <typename T>
void add_once(const T& value, std::vector<T>& list) {
  if (std::find(list.begin(), list.end(), value) == list.end()) list.push_back(value);
}

}  // namespace

/// The expected gap between the true and the wrong one is T (1 - rho^2).
std::vector<std::size_t> too_close(const ScoreTable& table, std::size_t candidate,
                                   const std::vector<std::size_t>& others) {
  const std::vector<double> correlations = table.correlations(candidate, others);
  const double statistic = table.scores()[candidate].statistic;
  std::vector<std::size_t> close;
  for (std::size_t k = 0; k < others.size(); ++k)
    if (const double rho = correlations[k];
        rho > settings::kAlias && statistic * (1.0 - rho * rho) < settings::kSeparable)
      close.push_back(others[k]);
  return close;
}

std::vector<vehicle::Covariate> covariates_like(const std::vector<Candidate>& candidates,
                                                const ScoreTable& table, std::size_t index) {
  const vehicle::Covariate own = candidates[index].smooth->dependence.covariate;
  const double least = settings::kMostOfStatistic * table.scores()[index].statistic;
  std::vector<std::size_t> others;
  for (std::size_t k = 0; k < candidates.size(); ++k)
    if (!candidates[k].excluded && candidates[k].smooth &&
        candidates[k].smooth->dependence.covariate != own && table.scores()[k].statistic >= least)
      others.push_back(k);
  const std::vector<double> correlations = table.correlations(index, others);
  std::vector<vehicle::Covariate> alike;
  for (std::size_t k = 0; k < others.size(); ++k)
    if (correlations[k] > settings::kAlias)
      add_once(candidates[others[k]].smooth->dependence.covariate, alike);
  return alike;
}

std::vector<std::string> aliases_among(const std::vector<Candidate>& candidates, std::size_t candidate,
                                       const std::vector<std::size_t>& competitors) {
  const vehicle::Effect& effect = *candidates[candidate].effect;
  std::vector<std::string> aliases = effect.observationally_equivalent();
  for (const std::size_t competitor : competitors)
    if (candidates[competitor].effect->name() != effect.name())
      add_once(candidates[competitor].effect->name(), aliases);
  return aliases;
}

}  // namespace odomcalib::calib::selection
