#include "calib/selection/hyperparameters.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/math/linear_solve.hpp"
#include "calib/selection/cross_validation.hpp"
#include "calib/selection/plausibility.hpp"
#include "calib/selection/settings.hpp"
#include "calib/terms/candidate_smooths.hpp"
#include "calib/terms/effects/reference_effect.hpp"
#include "calib/terms/smooth_term.hpp"
#include "calib/terms/smooth_term_effect.hpp"
#include "calib/terms/smooth_term_on_drives.hpp"

namespace odomcalib::calib::selection {
namespace {

/// Base parameters that the channel scales.
std::vector<vehicle::BaseIndex> lengths_of(vehicle::Channel channel) {
  switch (channel) {
    case vehicle::Channel::left_travel:
      return {vehicle::kLeftRadius};
    case vehicle::Channel::right_travel:
      return {vehicle::kRightRadius};
    case vehicle::Channel::both_travel:
      return {vehicle::kLeftRadius, vehicle::kRightRadius};
    case vehicle::Channel::track:
      return {vehicle::kTrackWidth};
    case vehicle::Channel::scale:
      return {vehicle::kLeftRadius, vehicle::kRightRadius, vehicle::kTrackWidth};
    default:
      return {};
  }
}

/// A steady turn along the path is what unequal wheels do.
bool may_pass_for_a_length(const vehicle::Effect& effect) {
  const auto& dependences = effect.dependences();
  return std::any_of(dependences.begin(), dependences.end(), [](const vehicle::Dependence& dependence) {
    return dependence.channel == vehicle::Channel::yaw_path || !lengths_of(dependence.channel).empty();
  });
}

/// Parameters of the model with the effect's shape that of the variant; nullopt if they are the model's own.
std::optional<Eigen::VectorXd> in_shape_of(const vehicle::Effect& variant, const FittedModel& model,
                                           std::size_t index) {
  Eigen::VectorXd start = model.fit.parameters;
  Eigen::Index k = first_parameter(model.effects, index);
  for (const vehicle::EffectParameter& parameter : variant.parameters()) {
    if (parameter.fixed) start(k) = parameter.start;
    ++k;
  }
  return start == model.fit.parameters ? std::nullopt : std::optional(start);
}

/// Relative changes of one length, each with the motion that it acted on.
class Changes {
 public:
  void add(double change, double motion) {
    if (!(motion > 0.0)) return;
    all_.emplace_back(change, motion);
    total_ += motion;
  }
  /// The part of the change that the length itself may have taken over.
  /// @param two_states the change from one to the other; otherwise the least of the changes' sizes that all
  /// but a tenth of the motion exceed on one side of zero
  [[nodiscard]] double unknown(bool two_states) {
    std::sort(all_.begin(), all_.end());
    const double low = quantile(settings::kQuietShare), high = quantile(1.0 - settings::kQuietShare);
    if (two_states) return high - low;
    return low * high > 0.0 ? std::min(std::abs(low), std::abs(high)) : 0.0;
  }

 private:
  [[nodiscard]] double quantile(double share) const {
    double sum = 0.0;
    for (const auto& [change, motion] : all_)
      if ((sum += motion) >= share * total_) return change;
    return 0.0;
  }

  std::vector<std::pair<double, double>> all_;
  double total_ = 0.0;
};

std::span<const double> values_of(const FittedModel& model, std::size_t index) {
  const auto first = static_cast<std::size_t>(first_parameter(model.effects, index));
  return vehicle::as_span(model.fit.parameters).subspan(first, model.effects[index]->parameters().size());
}

/// The drive can separate it from the wheels, and robots may be that bad.
bool is_credible(const FitTask& task, const vehicle::Effect& smooth, const estimation::FitResult& before,
                 const estimation::FitResult& after) {
  return (!smooth_spoils_base(smooth, before, after) && impossibility(smooth, after).empty()) ||
         !task.rules.has(Rule::credible_shape);
}

/// Polynomials of a lower degree.
bool is_plainer(const terms::SmoothTerm& shape, const terms::SmoothTerm& smooth) {
  const auto *a = terms::basis_as<terms::Polynomials>(shape),
             *b = terms::basis_as<terms::Polynomials>(smooth);
  return a && b && a->degree < b->degree;
}

/// nullopt if it is not credible.
std::optional<Reshaped> fitted_in_shape(const FitTask& task, const FittedModel& model,
                                        const terms::SmoothTerm& shape,
                                        const std::vector<measurement::NoiseModel>& noise) {
  const auto effect = make_smooth_term_effect(shape);
  auto fitted = with_effect(task, model, effect, noise);
  if (!fitted || !is_credible(task, *effect, model.fit, fitted->fit)) return std::nullopt;
  return Reshaped{shape, std::move(*fitted)};
}

}  // namespace

std::vector<Reshaped> reshaped(const FitTask& task, const Reshaped& now,
                               const std::vector<terms::SmoothTerm>& shapes) {
  const FittedModel& model = now.model;
  std::vector<Reshaped> all;
  const Eigen::Index kept = first_parameter(model.effects, model.effects.size() - 1);
  for (const terms::SmoothTerm& shape : shapes) {
    vehicle::EffectList effects = model.effects;
    effects.back() = make_smooth_term_effect(shape);
    Eigen::VectorXd start = model.fit.parameters;
    // As many functions say much the same; which pairs are outliers hangs on where the fit begins.
    if (function_count(shape) != function_count(now.smooth)) {
      start = Eigen::VectorXd::Zero(kept + static_cast<Eigen::Index>(function_count(shape)));
      start.head(kept) = model.fit.parameters.head(kept);
    }
    auto fit = task.fit(effects, start, model.fit.noise);
    if (!fit || !is_credible(task, *effects.back(), model.fit, *fit)) continue;
    all.push_back({shape, {std::move(effects), std::move(*fit)}});
  }
  return all;
}

std::optional<Reshaped> in_best_shape(const FitTask& task, const FittedModel& model,
                                      const terms::SmoothTerm& smooth,
                                      const std::vector<measurement::NoiseModel>& noise) {
  std::vector<terms::SmoothTerm> shapes = other_shapes(smooth, task.models());
  // A shape that is as plain as a name is no evidence against it.
  std::erase_if(shapes, [&](const terms::SmoothTerm& shape) { return is_plainer(shape, smooth); });
  shapes.push_back(smooth);
  std::optional<Reshaped> best;
  const auto misfit = [&](const FittedModel& m) {
    return m.fit.cost + schwarz(m.fit) * effective_parameters(m.fit);
  };
  for (const terms::SmoothTerm& shape : shapes) {
    auto fitted = fitted_in_shape(task, model, shape, noise);
    if (!fitted && shape.mean.empty() && may_be_centred(shape))
      fitted = fitted_in_shape(task, model, centred(shape, task.models()), noise);
    if (fitted && (!best || misfit(fitted->model) < misfit(best->model))) best = std::move(fitted);
  }
  return best;
}

bool explains_nearly_all(const FitTask& task, const FittedModel& named, std::size_t index,
                         const FittedModel& free) {
  const auto without = without_effect(task, named, index, named.fit.noise);
  return without && without->fit.cost - named.fit.cost >
                        settings::kNameShareOfSmooth * (without->fit.cost - free.fit.cost);
}

double effective_parameters(const estimation::FitResult& fit) {
  const Eigen::MatrixXd data = fit.whitened_jacobian.transpose() * fit.whitened_jacobian;
  const Eigen::MatrixXd all = data + fit.prior_information;
  Eigen::VectorXd scale = all.diagonal().cwiseSqrt();
  for (double& s : scale) s = s > 0.0 ? 1.0 / s : 0.0;
  Eigen::MatrixXd scaled = scale.asDiagonal() * all * scale.asDiagonal();
  for (Eigen::Index k = 0; k < scale.size(); ++k)
    if (scale(k) == 0.0) scaled(k, k) = 1.0;
  const Eigen::MatrixXd scaled_data = scale.asDiagonal() * data * scale.asDiagonal();
  return math::solve_symmetric(scaled, scaled_data).trace();
}

double schwarz(const estimation::FitResult& fit) {
  return std::log(static_cast<double>(fit.whitened_residual.size()));
}

bool is_better(const FitTask& task, const FittedModel& given, const FittedModel& other,
               double per_parameter) {
  const double more = effective_parameters(other.fit) - effective_parameters(given.fit);
  return given.fit.cost - other.fit.cost > per_parameter * more &&
         compared_on_held_out(task, given, other, validation::all_folds()).total > 0.0;
}

Eigen::VectorXd uncertainty_of_zero(const FitTask& task, const FittedModel& model,
                                    const terms::SmoothTerm& smooth) {
  Eigen::VectorXd uncertainty = Eigen::VectorXd::Zero(vehicle::kBaseCount);
  const bool leaves_mean = leaves_mean_to_wheels(smooth, task.models());
  // A memory of the past has no natural zero either: neither side of it is the robot as it was measured.
  if (smooth.mean.empty() && !is_memory(smooth.dependence.covariate) && !leaves_mean) return uncertainty;
  const Eigen::VectorXd own = model.fit.parameters.tail(static_cast<Eigen::Index>(function_count(smooth)));
  // A term that changes as the day goes is often right at one end of it.
  const bool goes_with_time = smooth.dependence.covariate == vehicle::Covariate::time;
  const double spread =
      (goes_with_time ? terms::half_span_of : terms::spread_of)(smooth, vehicle::as_span(own), task.models());
  Eigen::Index wheel_of_event = 0;
  for (const auto k : lengths_of(smooth.dependence.channel))
    uncertainty(k) =
        (happens_at_once(smooth) ? 0.5 * own(wheel_of_event++) : spread) * model.fit.parameters(k);
  if (leaves_mean) {
    const double wheel =
        0.5 * model.fit.parameters(vehicle::kTrackWidth) * spread;  // m for each metre of way
    uncertainty(vehicle::kLeftRadius) = -wheel * model.fit.parameters(vehicle::kLeftRadius);
    uncertainty(vehicle::kRightRadius) = wheel * model.fit.parameters(vehicle::kRightRadius);
  }
  return uncertainty;
}

Eigen::VectorXd uncertainty_of_extrapolation(const FitTask& task, const FittedModel& model,
                                             const std::vector<std::size_t>& dependence) {
  Eigen::VectorXd uncertainty = Eigen::VectorXd::Zero(vehicle::kBaseCount);
  if (terms::concerns_reference(*model.effects[dependence.front()])) return uncertainty;
  const bool two_states = dependence.size() > 1 || model.effects[dependence.front()]->has_two_states();
  Changes left, right, track;
  for (const vehicle::DriveModel* drive : task.models())
    for (const vehicle::StepContext& c : drive->context()) {
      vehicle::WheelStep<double> step{c.left_delta, c.right_delta};
      for (const std::size_t e : dependence) model.effects[e]->apply(c, values_of(model, e), step);
      left.add(step.left / c.left_delta - 1.0, std::abs(c.left_delta));
      right.add(step.right / c.right_delta - 1.0, std::abs(c.right_delta));
      track.add(step.track - 1.0, std::abs(c.turn_rate) * c.dt);
    }
  // A term that ends where the data end, instead of going on to zero, is two deviations off.
  const auto share = [&](Changes& changes) { return 0.5 * changes.unknown(two_states); };
  uncertainty(vehicle::kLeftRadius) = share(left) * model.fit.parameters(vehicle::kLeftRadius);
  uncertainty(vehicle::kRightRadius) = share(right) * model.fit.parameters(vehicle::kRightRadius);
  uncertainty(vehicle::kTrackWidth) = share(track) * model.fit.parameters(vehicle::kTrackWidth);
  return uncertainty;
}

std::vector<Eigen::VectorXd> uncertainties_of_shape(const FitTask& task, const FittedModel& model,
                                                    std::size_t index) {
  const vehicle::Effect& effect = *model.effects[index];
  std::vector<Eigen::VectorXd> model_uncertainties;
  if (!may_pass_for_a_length(effect)) return model_uncertainties;
  std::vector<double> likelihoods;
  double all = 1.0;
  for (const auto& variant : effect.variants()) {
    const auto start = in_shape_of(*variant, model, index);
    const auto fit = start ? task.fit(model.effects, *start, model.fit.noise) : std::nullopt;
    if (!fit) continue;
    likelihoods.push_back(std::exp(std::min(0.0, 0.5 * (model.fit.cost - fit->cost))));
    all += likelihoods.back();
    model_uncertainties.emplace_back(fit->parameters.head<vehicle::kBaseCount>() - model.base());
  }
  for (std::size_t k = 0; k < model_uncertainties.size(); ++k)
    model_uncertainties[k] *= std::sqrt(likelihoods[k] / all);
  return model_uncertainties;
}

}  // namespace odomcalib::calib::selection
