#include "calib/selection/equivalent_models.hpp"

#include <algorithm>

namespace odomcalib::calib::selection {
namespace {

constexpr double kSeparable = 10.0;  ///< expected gap of -2 log L that separates two candidates
constexpr double kMost = 0.6;        ///< of a smooth term's statistic

template <typename T>
void add_once(const T& value, std::vector<T>& list) {
  if (std::find(list.begin(), list.end(), value) == list.end()) list.push_back(value);
}

}  // namespace

/// The expected gap between the true and the wrong one is T (1 - rho^2).
bool are_too_close(const ScoreTable& table, std::size_t a, std::size_t b) {
  const double rho = table.correlation(a, b);
  return rho > kAlias && table.scores()[a].statistic * (1.0 - rho * rho) < kSeparable;
}

std::vector<vehicle::Covariate> covariates_like(const std::vector<Candidate>& candidates,
                                                const ScoreTable& table, std::size_t index) {
  const vehicle::Covariate own = candidates[index].smooth->dependence.covariate;
  std::vector<vehicle::Covariate> alike;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (candidates[k].struck || !candidates[k].smooth || candidates[k].smooth->dependence.covariate == own)
      continue;
    if (table.scores()[k].statistic >= kMost * table.scores()[index].statistic &&
        table.correlation(index, k) > kAlias)
      add_once(candidates[k].smooth->dependence.covariate, alike);
  }
  return alike;
}

std::vector<std::string> aliases_among(const std::vector<Candidate>& candidates, std::size_t candidate,
                                       const std::vector<std::size_t>& rivals) {
  const vehicle::Effect& effect = *candidates[candidate].effect;
  std::vector<std::string> aliases = effect.always_alike();
  for (const std::size_t rival : rivals)
    if (candidates[rival].effect->name() != effect.name())
      add_once(candidates[rival].effect->name(), aliases);
  return aliases;
}

}  // namespace odomcalib::calib::selection
