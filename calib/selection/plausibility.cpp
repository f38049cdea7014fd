#include "calib/selection/plausibility.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "calib/math/linear_solve.hpp"
#include "calib/math/number_text.hpp"
#include "calib/selection/score.hpp"
#include "calib/selection/settings.hpp"
#include "calib/terms/smooth_term.hpp"
#include "calib/vehicle/settings.hpp"

namespace odomcalib::calib::selection {
namespace {

/// Value of each parameter of the fit's last effect.
Eigen::VectorXd last_parameters(const vehicle::Effect& effect, const estimation::FitResult& fit) {
  return fit.parameters.tail(static_cast<Eigen::Index>(effect.parameters().size()));
}

std::string outside(const vehicle::EffectParameter& parameter, double value) {
  const std::string unit = parameter.unit != "1" ? " " + parameter.unit : "";
  return parameter.name + " of " + math::significant(value, 3) + unit + " is outside its physical range";
}

bool moves_lengths(const estimation::FitResult& before, const estimation::FitResult& after) {
  for (const auto k : {vehicle::kLeftRadius, vehicle::kRightRadius, vehicle::kTrackWidth})
    if (std::abs(after.parameters(k) - before.parameters(k)) >
        settings::kMaxLengthShift * before.parameters(k))
      return true;
  return false;
}

}  // namespace

std::string impossibility(const vehicle::Effect& effect, const estimation::FitResult& fit) {
  const Eigen::VectorXd values = last_parameters(effect, fit);
  const auto& parameters = effect.parameters();
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const double value = values(static_cast<Eigen::Index>(k));
    if (!(value >= parameters[k].lower && value <= parameters[k].upper)) return outside(parameters[k], value);
  }
  return "";
}

std::string contradiction(const vehicle::Effect& effect, const estimation::FitResult& fit) {
  return effect.contradiction(vehicle::as_span(fit.parameters).last(effect.parameters().size()));
}

bool is_held_back(const vehicle::Effect& effect, const estimation::FitResult& fit) {
  const Eigen::VectorXd values = last_parameters(effect, fit);
  const auto& parameters = effect.parameters();
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (parameters[k].is_size() &&
        !(std::abs(values(static_cast<Eigen::Index>(k))) < settings::kNearBound * parameters[k].upper))
      return true;
  return false;
}

bool is_negligible(const vehicle::Effect& effect, const estimation::FitResult& fit) {
  return is_negligible(effect, static_cast<std::size_t>(fit.parameters.size()) - effect.parameters().size(),
                       fit);
}

bool is_negligible(const vehicle::Effect& effect, std::size_t first, const estimation::FitResult& fit) {
  const auto& parameters = effect.parameters();
  double largest = 0.0;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (parameters[k].is_size())
      largest = std::max(
          largest, std::abs(fit.parameters(static_cast<Eigen::Index>(first + k))) / parameters[k].scale);
  return largest < vehicle::settings::kNegligibleShare;
}

bool is_hidden_by_ticks(const terms::SmoothTerm& smooth, const estimation::FitResult& fit,
                        std::span<const vehicle::DriveModel* const> models) {
  const double strongest = std::max(std::abs(smooth.low), std::abs(smooth.high));  // rad/s^2
  double hidden = 0.0;
  for (const vehicle::DriveModel* model : models) {
    const wheels::WheelTrack& track = model->track();
    const double step =
        track.tick_angle * fit.parameters(vehicle::kLeftRadius) / fit.parameters(vehicle::kTrackWidth);
    hidden = std::max(hidden, strongest * track.tick_period * track.tick_period / 8.0 + step);
  }
  const Eigen::VectorXd own = fit.parameters.tail(static_cast<Eigen::Index>(function_count(smooth)));
  double sway = 0.0;
  for (const double share : {0.5, 1.0}) {
    vehicle::StepContext c;
    c.turn_acceleration_before.fill(share * strongest);
    c.turn_acceleration_after = c.turn_acceleration_before;
    const terms::BasisValues functions = functions_of(smooth, c);
    sway = std::max(sway, std::abs(std::inner_product(functions.begin(), functions.end(), own.data(), 0.0)));
  }
  return sway < settings::kAboveTicks * hidden;
}

bool spoils_base(const vehicle::Effect& effect, const estimation::FitResult& before,
                 const estimation::FitResult& after) {
  const double most = effect.storage() == vehicle::Storage::nowhere ? settings::kWidenedByNowhere
                                                                    : settings::kWidenedByCorrection;
  for (const auto k : {vehicle::kLeftRadius, vehicle::kRightRadius, vehicle::kTrackWidth}) {
    const double deviation = std::sqrt(after.covariance(k, k));
    if (deviation > settings::kNegligibleLengthStd * after.parameters(k) &&
        deviation > most * std::sqrt(before.covariance(k, k)))
      return true;
  }
  return false;
}

bool smooth_spoils_base(const vehicle::Effect& smooth, const estimation::FitResult& before,
                        const estimation::FitResult& after) {
  return moves_lengths(before, after) || spoils_base(smooth, before, after);
}

bool is_superfluous(const vehicle::Effect& effect, std::size_t first, const estimation::FitResult& fit) {
  std::vector<Eigen::Index> sizes;
  const auto& parameters = effect.parameters();
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (parameters[k].is_size()) sizes.push_back(static_cast<Eigen::Index>(first + k));
  const Eigen::VectorXd value = fit.parameters(sizes);
  const Eigen::MatrixXd covariance = fit.covariance(sizes, sizes);
  const double wald = value.dot(math::solve_symmetric(covariance, value));
  return chi_squared_tail(wald, sizes.size()) > settings::kNeededLevel;
}

}  // namespace odomcalib::calib::selection
