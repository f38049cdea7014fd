#include "calib/selection/change_point.hpp"

#include <utility>
#include <variant>
#include <vector>

#include "calib/selection/hyperparameters.hpp"
#include "calib/selection/settings.hpp"
#include "calib/terms/smooth_term_effect.hpp"
#include "calib/terms/smooth_term_on_drives.hpp"

namespace odomcalib::calib::selection {
namespace {

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

terms::SmoothTerm at_likeliest_change_point(const FitTask& task, const FittedModel& model,
                                            const terms::SmoothTerm& event) {
  auto with_event = with_effect(task, model, make_smooth_term_effect(event), model.fit.noise);
  return with_event ? at_best_change_point(task, {event, std::move(*with_event)}).smooth : event;
}

}  // namespace odomcalib::calib::selection
