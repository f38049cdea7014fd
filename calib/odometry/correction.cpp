#include "calib/odometry/correction.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "calib/odometry/settings.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/effects/reference_effect.hpp"
#include "calib/terms/fitted_smooth_term.hpp"
#include "calib/terms/lidar_effect.hpp"
#include "calib/terms/smooth_term_effect.hpp"
#include "proto/base_quantities.hpp"

namespace odomcalib::calib::odometry {
namespace {

/// The robot's own value where the calibration states none.
double value_of(const Calibration& calibration, BaseQuantity length) {
  return calibration.parameter(length).value_or(calibration.robot.*member_of(length));
}

/// A term that goes up and down with time begins the next drive anywhere, unless it rounds off a drift.
bool carries_over(const terms::FittedSmoothTerm& fitted) {
  const terms::SmoothTerm& smooth = fitted.smooth;
  if (make_smooth_term_effect(smooth)->carries_over()) return true;
  const auto named = terms::find_effect(fitted.named_term);
  return named && named->carries_over() && smooth.dependence.covariate == vehicle::Covariate::time &&
         !belongs_to_lidar(smooth);
}

/// Effects of the place or the day would make odometry worse elsewhere and tomorrow; an error of the lidar is
/// none of odometry.
Place place_of(const vehicle::Effect& effect) {
  if (terms::concerns_reference(effect)) return Place::reference;
  const bool stays_behind = effect.storage() == vehicle::Storage::nowhere && !effect.carries_over();
  return stays_behind ? Place::nowhere : Place::odometry;
}

Place place_of(const vehicle::Effect& effect, const vehicle::EffectParameter& parameter) {
  return parameter.of_wheels ? Place::odometry : place_of(effect);
}

Place place_of(const terms::FittedSmoothTerm& fitted) {
  return carries_over(fitted) ? Place::odometry : place_of(*make_smooth_term_effect(fitted.smooth));
}

/// @param parameter name of one, as a file states it
Place place_of(const vehicle::Effect& effect, const std::string& parameter) {
  for (const vehicle::EffectParameter& own : effect.parameters())
    if (own.name == parameter) return place_of(effect, own);
  return place_of(effect);
}

bool acts_on_odometry(const vehicle::Effect& effect) {
  const auto& parameters = effect.parameters();
  return std::any_of(parameters.begin(), parameters.end(), [&](const vehicle::EffectParameter& p) {
    return place_of(effect, p) == Place::odometry;
  });
}

/// The effect that the values were fitted for; null when this program does not know it.
std::shared_ptr<const vehicle::Effect> effect_of(const EffectResult& result) {
  if (result.parameters.empty()) return nullptr;
  const auto effect = terms::find_effect(result.name, result.parameters.front().first);
  return effect && result.parameters.size() <= effect->parameters().size() ? effect : nullptr;
}

/// Parameters that the file does not state, as those of another program may not, stay where a fit begins.
std::vector<double> values_of(const EffectResult& result,
                              const std::shared_ptr<const vehicle::Effect>& effect) {
  std::vector<double> values = vehicle::start_of({effect});
  for (std::size_t k = 0; k < result.parameters.size(); ++k) values[k] = result.parameters[k].second.value;
  return values;
}

/// Zero where the file states none, as for a shape that was tried at several values.
std::vector<double> deviations_of(const EffectResult& result, std::size_t count) {
  std::vector<double> deviations(count, 0.0);
  for (std::size_t k = 0; k < result.parameters.size(); ++k)
    if (const double std = result.parameters[k].second.std; std > 0.0) deviations[k] = std;
  return deviations;
}

/// Covariance of radii, track width and mount in the order of the parameter vector, m and rad; zero where the
/// file has none, or no finite one.
Eigen::MatrixXd base_covariance(const Calibration& calibration) {
  const auto& order = calibration.covariance_order;
  const auto place = [&](std::size_t k) {
    return static_cast<std::size_t>(std::find(order.begin(), order.end(), kBaseQuantities.at(k).name) -
                                    order.begin());
  };
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(vehicle::kBaseCount, vehicle::kBaseCount);
  if (calibration.covariance.size() != order.size()) return covariance;
  const auto of_stated = [](std::size_t k) { return 1.0 / kBaseQuantities.at(k).per_fitted; };
  for (std::size_t a = 0; a < kBaseQuantities.size(); ++a)
    for (std::size_t b = 0; b < kBaseQuantities.size(); ++b)
      if (place(a) < order.size() && place(b) < order.size())
        covariance(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) =
            of_stated(a) * of_stated(b) * calibration.covariance[place(a)][place(b)];
  return covariance.allFinite() ? covariance
                                : Eigen::MatrixXd::Zero(vehicle::kBaseCount, vehicle::kBaseCount);
}

std::vector<terms::FittedSmoothTerm> smooths_of(const Calibration& calibration) {
  return terms::smooth_terms_of(calibration.curves);
}

}  // namespace

DriveClock::DriveClock(const Calibration& calibration) {
  if (calibration.data.empty()) return;
  const DataUse& drive = calibration.data.front();
  duration_ = drive.duration;
  // Several drives share no zero of time.
  if (calibration.data.size() == 1) calibrated_ = drive.begin;
}

void DriveClock::start(double stamp) {
  begin_.reset();
  if (!calibrated_) return;
  const double since = stamp - *calibrated_;
  if (since >= -settings::kTogether_s && since <= settings::kAfterTheDrive * duration_) begin_ = calibrated_;
}

double DriveClock::at(double stamp) const {
  return begin_ ? std::clamp(stamp - *begin_, 0.0, duration_) : duration_ / 2.0;
}

Correction correction_of(const Calibration& calibration, bool time_is_known) {
  wheels::BaseParameters base;
  base.left_radius = value_of(calibration, BaseQuantity::left_wheel_diameter) / 2.0;
  base.right_radius = value_of(calibration, BaseQuantity::right_wheel_diameter) / 2.0;
  base.track_width = value_of(calibration, BaseQuantity::track_width);
  const Eigen::VectorXd start = vehicle::to_vector(base);
  std::vector<double> values(start.begin(), start.end()), deviations(values.size(), 0.0);
  Correction correction;
  for (const EffectResult& result : calibration.effects) {
    const auto effect = effect_of(result);
    if (!effect || !acts_on_odometry(*effect)) continue;
    correction.effects.push_back(effect);
    const std::vector<double> own = values_of(result, effect), of_own = deviations_of(result, own.size());
    values.insert(values.end(), own.begin(), own.end());
    deviations.insert(deviations.end(), of_own.begin(), of_own.end());
  }
  for (const terms::FittedSmoothTerm& fitted : smooths_of(calibration)) {
    if (place_of(fitted) != Place::odometry) continue;
    if (fitted.smooth.dependence.covariate == vehicle::Covariate::time && !time_is_known) continue;
    correction.effects.push_back(make_smooth_term_effect(fitted.smooth));
    values.insert(values.end(), fitted.coefficients.begin(), fitted.coefficients.end());
    deviations.resize(values.size(), 0.0);
  }
  const auto count = static_cast<Eigen::Index>(values.size());
  correction.parameters = Eigen::Map<const Eigen::VectorXd>(values.data(), count);
  correction.covariance =
      Eigen::Map<const Eigen::VectorXd>(deviations.data(), count).cwiseAbs2().asDiagonal();
  correction.covariance.topLeftCorner<vehicle::kBaseCount, vehicle::kBaseCount>() =
      base_covariance(calibration);
  return correction;
}

std::vector<Placement> effect_placements(const Calibration& calibration) {
  std::vector<Placement> placements;
  for (const EffectResult& result : calibration.effects) {
    const auto effect = effect_of(result);
    const Place otherwise = terms::find_lidar_effect(result.name) ? Place::reference : Place::nowhere;
    for (const auto& [name, quantity] : result.parameters)
      placements.push_back({result.name, name, quantity, effect ? place_of(*effect, name) : otherwise});
  }
  for (const terms::FittedSmoothTerm& fitted : smooths_of(calibration)) {
    const Quantity count{static_cast<double>(fitted.coefficients.size()), -1.0, "coefficients"};
    placements.push_back({make_smooth_term_effect(fitted.smooth)->name(), "", count, place_of(fitted)});
  }
  return placements;
}

std::vector<std::string> unknown_effects(const Calibration& calibration) {
  std::vector<std::string> names;
  for (const EffectResult& result : calibration.effects)
    if (!effect_of(result) && !terms::find_lidar_effect(result.name)) names.push_back(result.name);
  return names;
}

Calibration nominal_calibration(const RobotDescription& robot) {
  Calibration calibration;
  calibration.robot = robot;
  for (const BaseQuantity length : kDriveLengths)
    calibration.parameters.push_back(
        {name_of(length), {robot.*member_of(length), -1.0, row_of(length).unit}});
  calibration.reasons = {"nominal values"};
  return calibration;
}

}  // namespace odomcalib::calib::odometry
