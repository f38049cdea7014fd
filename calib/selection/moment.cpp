#include "calib/selection/moment.hpp"

#include <utility>
#include <variant>
#include <vector>

#include "calib/selection/law_shape.hpp"
#include "calib/selection/settings.hpp"
#include "calib/terms/curve.hpp"
#include "calib/terms/curve_effect.hpp"
#include "calib/terms/curve_on_drives.hpp"

namespace odomcalib::calib::selection {
namespace {

terms::Curve at_moment(const FitTask& task, terms::Curve event, double moment) {
  return as_of_the_drive(on_basis(std::move(event), terms::ChangePoint{moment}), task.models());
}

/// Sought ever closer, from half a step between candidates on.
/// @param now whose model ends with the event
Reshaped at_best_moment(const FitTask& task, Reshaped now) {
  constexpr int kEachWay = 2, kRounds = 4;
  double step = 0.5 * now.curve.high / terms::kMoments;
  for (int round = 0; round < kRounds; ++round, step /= kEachWay) {
    std::vector<terms::Curve> others;
    for (int k = -kEachWay; k <= kEachWay; ++k) {
      const double moment = std::get<terms::ChangePoint>(now.curve.basis).moment + k * step;
      if (k != 0 && moment > 0.0 && moment < now.curve.high)
        others.push_back(at_moment(task, now.curve, moment));
    }
    for (Reshaped& other : reshaped(task, now, others))
      if (other.model.fit.cost < now.model.fit.cost) now = std::move(other);
  }
  return now;
}

std::optional<Reshaped> likeliest(const FitTask& task, const FittedModel& model, const terms::Curve& event) {
  auto with_event = with_effect(task, model, make_curve_effect(event), model.fit.noise);
  if (!with_event) return std::nullopt;
  return at_best_moment(task, {event, std::move(*with_event)});
}

}  // namespace

terms::Curve at_likeliest_moment(const FitTask& task, const FittedModel& model, const terms::Curve& event) {
  const auto best = likeliest(task, model, event);
  return best ? best->curve : event;
}

std::optional<std::size_t> event_instead_of(const FitTask& task, const SearchRound& round,
                                            const Trial& name) {
  const auto events = round.by_score([&](std::size_t k) {
    const auto& curve = round.candidate(k).curve;
    return curve && happens_at_once(*curve) && acts_on(*curve).size() > 1 &&
           round.score(k).family_p_value <= settings::kNamedLevel;
  });
  if (events.empty()) return std::nullopt;
  const auto best = likeliest(task, round.basis(), *round.candidate(events.front()).curve);
  // Its moment is one more choice.
  const bool is_better = best && best->model.fit.cost + schwarz(name.model.fit) < name.model.fit.cost;
  return is_better ? std::optional(events.front()) : std::nullopt;
}

}  // namespace odomcalib::calib::selection
