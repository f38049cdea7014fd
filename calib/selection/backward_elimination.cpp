#include "calib/selection/backward_elimination.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "calib/selection/hyperparameters.hpp"
#include "calib/selection/plausibility.hpp"

namespace odomcalib::calib::selection {
namespace {

/// A name whose function was completed bit by bit shares its dependence with the smooth term; what happens at
/// one moment may leave it nothing.
bool shares_its_ground(const SearchResult& result, const std::shared_ptr<const vehicle::Effect>& name) {
  return std::any_of(result.smooths.begin(), result.smooths.end(), [&](const AddedSmoothTerm& added) {
    return added.named_term == name && !happens_at_once(added.smooth);
  });
}

/// What was added last was just cross-validated.
bool may_eliminate(const SearchResult& result, const std::shared_ptr<const vehicle::Effect>& effect) {
  if (effect == result.model.effects.back()) return false;
  const auto is_it = [&](const auto& added) { return added.effect == effect; };
  if (std::any_of(result.findings.begin(), result.findings.end(), is_it))
    return !shares_its_ground(result, effect);
  if (std::count(result.nuisance.begin(), result.nuisance.end(), effect) > 0) return true;
  return std::any_of(result.smooths.begin(), result.smooths.end(), is_it);
}

/// The model without the effect, if that is as good.
std::optional<FittedModel> as_good_without(const FitTask& task, const FittedModel& model, std::size_t index,
                                           double per_parameter) {
  auto fewer = without_effect(task, model, index, model.fit.noise);
  if (!fewer) return std::nullopt;
  const auto first = static_cast<std::size_t>(first_parameter(model.effects, index));
  const bool is_needed = !is_superfluous(*model.effects[index], first, model.fit) &&
                         is_better(task, *fewer, model, per_parameter);
  return is_needed ? std::nullopt : std::move(fewer);
}

bool eliminate_one(const FitTask& task, double per_parameter, SearchResult& result) {
  for (std::size_t e = 0; e < result.model.effects.size(); ++e) {
    const auto effect = result.model.effects[e];
    if (!may_eliminate(result, effect)) continue;
    auto fewer = as_good_without(task, result.model, e, per_parameter);
    if (!fewer) continue;
    result.model = std::move(*fewer);
    result.forget(effect);
    return true;
  }
  return false;
}

}  // namespace

bool eliminate_superfluous(const FitTask& task, double per_parameter, SearchResult& result) {
  bool has_changed = false;
  while (eliminate_one(task, per_parameter, result)) has_changed = true;
  return has_changed;
}

}  // namespace odomcalib::calib::selection
