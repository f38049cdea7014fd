#include "calib/selection/detectable.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "calib/selection/candidate.hpp"
#include "calib/selection/score.hpp"
#include "calib/selection/settings.hpp"
#include "calib/vehicle/settings.hpp"

namespace odomcalib::calib::selection {
namespace {

std::vector<Candidate> textbook_names(const FitTask& task, const FittedModel& model) {
  std::vector<Candidate> names = names_missing(model.effects, task.data.size() == 1);
  std::erase_if(names, [](const Candidate& c) { return !has_textbook_shape(c.effect); });
  return names;
}

Detectable detectable(const vehicle::Effect& effect, const std::vector<double>& deviations) {
  Detectable best{effect.name(), "", "", std::nullopt, 0.0, effect.separating_motion()};
  double least = std::numeric_limits<double>::infinity();  // in typical sizes
  const auto& parameters = effect.parameters();
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const vehicle::EffectParameter& parameter = parameters[k];
    if (!parameter.is_size()) continue;
    const double smallest = std::max(settings::kDetectableQuantiles * deviations[k],
                                     vehicle::settings::kNegligibleShare * parameter.scale);
    const bool is_first = best.parameter.empty();
    if (!is_first && !(smallest / parameter.scale < least)) continue;
    least = smallest / parameter.scale;
    best.parameter = parameter.name;
    best.unit = parameter.unit;
    best.typical = parameter.scale;
    if (smallest < std::numeric_limits<double>::infinity()) best.smallest = smallest;
  }
  return best;
}

}  // namespace

std::vector<Detectable> smallest_detectable(const FitTask& task, const FittedModel& model) {
  const std::vector<Candidate> names = textbook_names(task, model);
  const ScoreTable table(task, model, names);
  std::vector<Detectable> all;
  for (std::size_t k = 0; k < names.size(); ++k)
    all.push_back(detectable(*names[k].effect, table.scores()[k].deviations));
  return all;
}

}  // namespace odomcalib::calib::selection
