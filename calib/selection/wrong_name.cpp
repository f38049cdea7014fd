#include "calib/selection/wrong_name.hpp"

#include <utility>

namespace odomcalib::calib::selection {

std::optional<FreeTerm> free_term_instead_of(const FitTask& task, const FittedModel& model, std::size_t index,
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
  const auto missing =
      objection(task, *without, dependence->model, all_folds(), largest_ratio(candidate), validation);
  return missing.empty() ? std::optional(FreeTerm{std::move(*dependence), validation}) : std::nullopt;
}

}  // namespace odomcalib::calib::selection
