#include "calib/selection/backward_elimination.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "calib/selection/hyperparameters.hpp"
#include "calib/selection/plausibility.hpp"
#include "calib/selection/settings.hpp"
#include "calib/validation/drive_error.hpp"

namespace odomcalib::calib::selection {
namespace {

/// A name whose function was completed bit by bit shares its dependence with the smooth term; what happens at
/// one moment may leave it nothing.
bool shares_its_ground(const SearchResult& result, const std::shared_ptr<const vehicle::Effect>& name) {
  return std::any_of(result.smooths.begin(), result.smooths.end(), [&](const AddedSmoothTerm& added) {
    return added.named_term == name && !happens_at_once(added.smooth);
  });
}

/// The effect added last was just cross-validated.
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

/// Error of odometry over ten seconds with the model's effects; nullopt where the drive is too short for it.
std::optional<DriveError> open_loop_error(const FitTask& task, const FittedModel& model) {
  const validation::JudgedModel judged{&model.fit, task.fixed(model.effects), model.effects};
  const auto errors = validation::drive_errors(task.data, {}, nullptr, judged);
  const DriveError* found = validation::open_loop_position(errors);
  return found == nullptr || !found->after || !found->noise_floor ? std::nullopt : std::optional(*found);
}

}  // namespace

bool eliminate_superfluous(const FitTask& task, double per_parameter, SearchResult& result) {
  bool has_changed = false;
  while (eliminate_one(task, per_parameter, result)) has_changed = true;
  return has_changed;
}

std::optional<FreeTerm> free_alternative_to(const FitTask& task, const FittedModel& model, std::size_t index,
                                            const Candidate& candidate) {
  const auto without = without_effect(task, model, index, {});
  if (!without) return std::nullopt;
  auto dependence = in_best_shape(task, *without, *candidate.smooth, model.fit.noise);
  if (!dependence ||
      (explains_nearly_all(task, model, index, dependence->model) &&
       task.rules.has(Rule::nearly_all_explained)) ||
      !is_better(task, model, dependence->model, schwarz(model.fit)))
    return std::nullopt;
  CrossValidation validation;
  const auto missing = objection(task, *without, dependence->model, validation::all_folds(), validation);
  return missing.empty() ? std::optional(FreeTerm{std::move(*dependence), validation}) : std::nullopt;
}

bool explain_too_little(const FitTask& task, const FittedModel& with, const FittedModel& without) {
  const auto after = open_loop_error(task, with), before = open_loop_error(task, without);
  if (!after || !before) return false;
  const auto square = [](double x) { return x * x; };
  const double all = square(before->after->value) - square(*after->noise_floor);
  return square(before->after->value) - square(after->after->value) < settings::kLeastExplained * all;
}

}  // namespace odomcalib::calib::selection
