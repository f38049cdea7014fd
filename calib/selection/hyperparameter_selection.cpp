#include "calib/selection/hyperparameter_selection.hpp"

#include <cmath>
#include <utility>
#include <variant>
#include <vector>

#include "calib/selection/hyperparameters.hpp"
#include "calib/selection/settings.hpp"
#include "calib/terms/candidate_smooths.hpp"
#include "calib/terms/smooth_term.hpp"
#include "calib/terms/smooth_term_effect.hpp"
#include "calib/terms/smooth_term_on_drives.hpp"

namespace odomcalib::calib::selection {
namespace {

/// Costs compare on the same noise only; while noise was estimated, that of the step before was used.
void fit_anew_on_own_noise(const FitTask& task, FittedModel& model) {
  if (auto again = task.fit(model.effects, model.fit.parameters, model.fit.noise))
    model.fit = std::move(*again);
}

/// A term of a speed or a force has a peak or a step, not one bend after the other: those stand for the
/// single manoeuvres of this drive. Bends of less than a quarter of all that the function spans are none.
bool bends_too_often(const Reshaped& shape) {
  if (terms::basis_as<terms::Cycle>(shape.smooth) ||
      shape.smooth.dependence.covariate == vehicle::Covariate::time)
    return false;
  const auto count = static_cast<Eigen::Index>(function_count(shape.smooth));
  const Eigen::VectorXd values = shape.model.fit.parameters.tail(count);
  const double plain = settings::kPlainBend * (values.maxCoeff() - values.minCoeff());
  int bends = 0;
  double from = values(0), way = 0.0;  // of the last plain rise or fall
  for (Eigen::Index k = 1; k < count; ++k) {
    const double change = values(k) - from;
    if (std::abs(change) <= plain) continue;
    if (change * way < 0.0) ++bends;
    way = change;
    from = values(k);
  }
  return bends > settings::kMostBends;
}

void take_shape(const Reshaped& shape, SearchResult& result) {
  result.model = shape.model;
  result.smooths.back().smooth = shape.smooth;
  result.smooths.back().effect = shape.model.effects.back();
}

/// On noise that is estimated anew: the coarser shape's misfit was a part of it.
void fit_anew_on_estimated_noise(const FitTask& task, FittedModel& model) {
  if (auto again = task.fit(model.effects, model.fit.parameters, {})) model.fit = std::move(*again);
  fit_anew_on_own_noise(task, model);
}

/// A term's splines are smooth all alike at first, then each bend as it was found.
std::vector<terms::SmoothTerm> shapes_to_try(const FitTask& task, const Reshaped& now) {
  const auto* splines = terms::basis_as<terms::Splines>(now.smooth);
  if (!splines || splines->roughness.empty()) return other_shapes(now.smooth, task.models());
  return as_rough_as(now.smooth, vehicle::as_span(now.model.fit.parameters).last(function_count(now.smooth)));
}

bool take_best_shape(const FitTask& task, const std::vector<Reshaped>& shapes, SearchResult& result) {
  bool is_new = false;
  for (const Reshaped& other : shapes) {
    if ((bends_too_often(other) && task.rules.has(Rule::few_bends)) ||
        !is_better(task, result.model, other.model, settings::kAkaike))
      continue;
    take_shape(other, result);
    is_new = true;
  }
  return is_new;
}

/// Shape and noise settle each other.
/// @return the shapes that were tried last, the one before them at the end
std::vector<Reshaped> select_hyperparameters(const FitTask& task, SearchResult& result) {
  if (!task.rules.has(Rule::best_shape)) return {{result.smooths.back().smooth, result.model}};
  std::vector<Reshaped> shapes;
  for (int round = 0; round < settings::kShapeRounds; ++round) {
    const Reshaped now{result.smooths.back().smooth, result.model};
    shapes = reshaped(task, now, shapes_to_try(task, now));
    const bool is_new = take_best_shape(task, shapes, result);
    shapes.push_back(now);
    if (!is_new) break;
    fit_anew_on_estimated_noise(task, result.model);
  }
  return shapes;
}

terms::SmoothTerm at_change_point(const FitTask& task, terms::SmoothTerm event, double moment) {
  return as_of_the_drive(on_basis(std::move(event), terms::ChangePoint{moment}), task.models());
}

/// Sought ever closer, from half a step between candidates on.
/// @param now whose model ends with the event
Reshaped at_best_change_point(const FitTask& task, Reshaped now) {
  double step = 0.5 * now.smooth.high / terms::kChangePoints;
  for (int round = 0; round < settings::kMomentRounds; ++round, step /= settings::kMomentsEachWay) {
    std::vector<terms::SmoothTerm> others;
    for (int k = -settings::kMomentsEachWay; k <= settings::kMomentsEachWay; ++k) {
      const double moment = std::get<terms::ChangePoint>(now.smooth.basis).moment + k * step;
      if (k != 0 && moment > 0.0 && moment < now.smooth.high)
        others.push_back(at_change_point(task, now.smooth, moment));
    }
    for (Reshaped& other : reshaped(task, now, others))
      if (other.model.fit.cost < now.model.fit.cost) now = std::move(other);
  }
  return now;
}

}  // namespace

void select_hyperparameters_of_newest(const FitTask& task, SearchResult& result) {
  fit_anew_on_own_noise(task, result.model);
  const std::vector<Reshaped> shapes = select_hyperparameters(task, result);
  for (const Reshaped& other : shapes)
    if (other.model.fit.cost < result.model.fit.cost + schwarz(result.model.fit))
      result.model_uncertainties.emplace_back(other.model.base() - result.model.base());
  result.model_uncertainties.push_back(uncertainty_of_zero(task, result.model, result.smooths.back().smooth));
}

terms::SmoothTerm at_likeliest_change_point(const FitTask& task, const FittedModel& model,
                                            const terms::SmoothTerm& event) {
  auto with_event = with_effect(task, model, make_smooth_term_effect(event), model.fit.noise);
  return with_event ? at_best_change_point(task, {event, std::move(*with_event)}).smooth : event;
}

}  // namespace odomcalib::calib::selection
