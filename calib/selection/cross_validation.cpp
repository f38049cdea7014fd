#include "calib/selection/cross_validation.hpp"

#include <algorithm>
#include <optional>

#include "calib/selection/settings.hpp"

namespace odomcalib::calib::selection {

validation::HeldOutGain compared_on_held_out(const FitTask& task, const FittedModel& before,
                                             const FittedModel& after,
                                             const validation::FoldFlags& selected) {
  std::vector<double> weights(after.fit.weights.size());
  std::transform(after.fit.weights.begin(), after.fit.weights.end(), before.fit.weights.begin(),
                 weights.begin(), [](double a, double b) { return std::max(a, b); });
  return validation::held_out_gain(
      task.data, with_weights(task.data, before.effects, before.fit, weights), task.fixed(before.effects),
      with_weights(task.data, after.effects, after.fit, weights), task.fixed(after.effects), selected);
}

namespace {

/// Both models over the same windows.
struct GainComparison {
  validation::WindowErrors without, with;
};

/// Too few of a kind say nothing.
/// @param measured pairs that windows may cross
std::optional<GainComparison> compared(validation::WindowKind kind, const FitTask& task,
                                       const FittedModel& before, const FittedModel& after,
                                       const std::vector<bool>& measured) {
  const auto windows =
      validation::find_windows(kind, task.data, validation::folds_of(task.data), before.fit, measured);
  if (windows.size() < settings::kFewestWindows) return std::nullopt;
  const auto error_of = [&](const FittedModel& model) {
    return validation::window_errors(task.data, windows, model.effects, model.fit, task.fixed(model.effects));
  };
  return GainComparison{error_of(before), error_of(after)};
}

/// Errors over ten seconds, after only where the other folds point to the candidate.
struct Gain {
  double before = 0.0, after = 0.0;
  validation::Improvement improvement;
  [[nodiscard]] bool is_proved() const { return improvement.upper < 1.0; }
};

std::optional<Gain> gain_over(const FitTask& task, const FittedModel& before, const FittedModel& after,
                              const validation::FoldFlags& selected, const std::vector<bool>& measured) {
  const auto windows = compared(validation::WindowKind::open_loop, task, before, after, measured);
  if (!windows) return std::nullopt;
  const validation::WindowErrors mixed =
      validation::where_selected(windows->without, windows->with, selected);
  return Gain{windows->without.rms_position(), mixed.rms_position(),
              validation::compare(windows->without, mixed)};
}

/// A rare error shows only where a fit takes pairs for failed matches, and one that always acts is drowned
/// there: a candidate may pass by either.
std::optional<Gain> best_gain(const FitTask& task, const FittedModel& before, const FittedModel& after,
                              const validation::FoldFlags& selected) {
  const auto trusted = validation::trusted_pairs(before.fit, after.fit);
  const auto usual = gain_over(task, before, after, selected, trusted);
  if (usual && usual->is_proved()) return usual;
  const auto measured = validation::measured_pairs(task.data, trusted);
  if (measured == trusted) return usual;
  const auto all = gain_over(task, before, after, selected, measured);
  return all && all->is_proved() ? all : usual;
}

}  // namespace

DriveChange change_of_drives(const FitTask& task, const FittedModel& before, const FittedModel& after) {
  const auto trusted = validation::trusted_pairs(before.fit, after.fit);
  DriveChange change;
  for (const auto kind :
       {validation::WindowKind::open_loop, validation::WindowKind::turn, validation::WindowKind::straight}) {
    const auto errors = compared(kind, task, before, after, trusted);
    if (!errors) continue;
    const validation::Improvement improvement = validation::compare(errors->without, errors->with);
    if (kind == validation::WindowKind::open_loop) change.ratio = improvement.ratio;
    change.is_spoilt = change.is_spoilt || improvement.lower > settings::kTolerated;
  }
  return change;
}

std::string objection(const FitTask& task, const FittedModel& before, const FittedModel& after,
                      const validation::FoldFlags& selected, CrossValidation& validation) {
  if (const auto gain = best_gain(task, before, after, selected)) {
    validation.before = gain->before;
    validation.after = gain->after;
    validation.improvement = gain->improvement;
    if (gain->is_proved()) return {};
    if (validation.improvement.lower > 1.0 && task.rules.has(Rule::certain_gain))
      return "held-out error rises";
  }
  const bool is_certain = compared_on_held_out(task, before, after, selected).lower > 0.0;
  return is_certain || !task.rules.has(Rule::certain_gain) ? "" : "no gain on held-out data";
}

}  // namespace odomcalib::calib::selection
