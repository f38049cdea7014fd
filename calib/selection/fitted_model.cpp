#include "calib/selection/fitted_model.hpp"

#include <algorithm>
#include <cmath>

#include "calib/measurement/noise_estimate.hpp"
#include "calib/selection/settings.hpp"

namespace odomcalib::calib::selection {
namespace {

/// Squared distance that a pair's weight stands for (the inverse of Student's t weight).
double squared_distance(double weight) {
  return ((measurement::kStudentDof + 3.0) / weight) -
         measurement::kStudentDof / measurement::kStudentConsistency;
}

/// How much larger the noise would have to be for that share of the residuals to be noise.
double excess_of_outliers(const estimation::FitResult& fit, double share) {
  if (fit.weights.empty()) return 1.0;
  std::vector<double> squared;
  for (const double w : fit.weights) squared.push_back(squared_distance(w));
  const auto nth =
      squared.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(squared.size() - 1));
  std::nth_element(squared.begin(), nth, squared.end());
  return std::sqrt(std::max(*nth, 0.0) / settings::kChiSquared95Of3);
}

measurement::NoiseModel widened(measurement::NoiseModel noise, double factor) {
  noise.matcher_scale *= factor;
  noise.process_translation *= factor;
  noise.process_rotation *= factor;
  noise.stamp_jitter *= factor;
  return noise;
}

}  // namespace

std::vector<const vehicle::DriveModel*> FitTask::models() const {
  std::vector<const vehicle::DriveModel*> all;
  for (const measurement::FitData& d : data) all.push_back(d.model);
  return all;
}

std::optional<estimation::FitResult> FitTask::fit(const vehicle::EffectList& effects,
                                                  const Eigen::VectorXd& start,
                                                  const std::vector<measurement::NoiseModel>& noise) const {
  estimation::FitOptions options;
  options.fixed = fixed(effects);
  options.max_iterations = settings::kMostSearchIterations;
  options.noise = noise;
  auto fit = fit_joint(data, effects, start, options);
  return fit ? std::optional(std::move(fit).value()) : std::nullopt;
}

std::optional<FittedModel> without_effect(const FitTask& task, const FittedModel& model, std::size_t index,
                                          const std::vector<measurement::NoiseModel>& noise) {
  vehicle::EffectList effects = model.effects;
  effects.erase(effects.begin() + static_cast<std::ptrdiff_t>(index));
  const Eigen::VectorXd& all = model.fit.parameters;
  const Eigen::Index first = first_parameter(model.effects, index);
  const Eigen::Index after = first_parameter(model.effects, index + 1);
  Eigen::VectorXd start(all.size() - (after - first));
  start << all.head(first), all.tail(all.size() - after);
  auto fit = task.fit(effects, start, noise);
  if (!fit) return std::nullopt;
  return FittedModel{std::move(effects), std::move(*fit)};
}

std::optional<FittedModel> with_effect(const FitTask& task, const FittedModel& model,
                                       const std::shared_ptr<const vehicle::Effect>& effect,
                                       const std::vector<measurement::NoiseModel>& noise) {
  vehicle::EffectList effects = model.effects;
  effects.push_back(effect);
  const std::vector<double> own = vehicle::start_of({effect});
  Eigen::VectorXd start(model.fit.parameters.size() + static_cast<Eigen::Index>(own.size()));
  start << model.fit.parameters,
      Eigen::Map<const Eigen::VectorXd>(own.data(), static_cast<Eigen::Index>(own.size()));
  auto fit = task.fit(effects, start, noise);
  if (!fit) return std::nullopt;
  return FittedModel{std::move(effects), std::move(*fit)};
}

estimation::FitResult widened_where_outlying(const FitTask& task, const FittedModel& model, double share) {
  const double excess = excess_of_outliers(model.fit, share);
  if (excess < settings::kToleratedExcess || !task.rules.has(Rule::wider_noise)) return model.fit;
  std::vector<measurement::NoiseModel> noise;
  for (const measurement::NoiseModel& given : model.fit.noise) noise.push_back(widened(given, excess));
  return task.fit(model.effects, model.fit.parameters, noise).value_or(model.fit);
}

}  // namespace odomcalib::calib::selection
