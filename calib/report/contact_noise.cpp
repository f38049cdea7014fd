#include "calib/report/contact_noise.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/measurement/whitening.hpp"
#include "calib/validation/settings.hpp"
#include "calib/vehicle/drive_model.hpp"

namespace odomcalib::calib::report {
namespace {

/// m, mean of both wheels, whichever way each rolls.
double way_rolled(const vehicle::DriveModel& model, const vehicle::Interval& interval,
                  const wheels::BaseParameters& base) {
  double way = 0.0, duration = 0.0;
  for (const vehicle::StepContext& step : model.context_within(interval)) {
    way +=
        0.5 * (base.left_radius * std::abs(step.left_delta) + base.right_radius * std::abs(step.right_delta));
    duration += step.dt;
  }
  // The first and the last of them reach beyond the motion.
  return duration > 0.0 ? way * std::min((interval.end - interval.begin) / duration, 1.0) : 0.0;
}

/// Errors that neighbours take back, as those of the scan that they share, are none of the wheels'.
Eigen::Vector3d variances_of_wheels(const measurement::SensorPair& pair,
                                    const measurement::NoiseModel& noise) {
  const double way = noise.process_translation, turn = noise.process_rotation;
  const Eigen::Vector3d all = base_covariance(pair, {}, noise).diagonal();
  Eigen::Vector3d variances(way * way, way * way, turn * turn);
  for (Eigen::Index k = 0; k < variances.size(); ++k) {
    const double lasting = 1.0 + 2.0 * noise.correlation.at(static_cast<std::size_t>(k));
    variances(k) = std::min(variances(k), std::max(lasting, 0.0) * all(k));
  }
  return variances;
}

std::vector<Eigen::Vector3d> errors_of(std::span<const validation::HeldOutError> held_out) {
  std::vector<Eigen::Vector3d> errors;
  errors.reserve(held_out.size());
  for (const validation::HeldOutError& one : held_out) errors.push_back(one.error);
  return errors;
}

}  // namespace

std::optional<odometry::IncrementNoise> contact_noise(const measurement::Dataset& dataset,
                                                      const selection::FittedModel& model,
                                                      std::span<const validation::HeldOutError> held_out) {
  if (held_out.empty()) return std::nullopt;
  const estimation::FitResult& fit = model.fit;
  const auto noise = noise_shown(dataset.data, model.effects, fit, errors_of(held_out));
  const wheels::BaseParameters base = vehicle::to_base(vehicle::as_span(fit.parameters));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double way = 0.0;
  std::size_t k = 0;
  for (std::size_t i = 0; i < dataset.data.size(); ++i)
    for (const measurement::SensorPair& pair : dataset.data[i].pairs) {
      if (fit.weights[k++] < validation::settings::kTrustedWeight) continue;
      sum += variances_of_wheels(pair, noise[i]);
      way += way_rolled(*dataset.data[i].model, pair.interval, base);
    }
  if (!(way > 0.0)) return std::nullopt;
  const Eigen::Vector3d per_metre = sum / way;
  const double lever = base.mount.x * base.mount.x + base.mount.y * base.mount.y;
  const double along = std::max(0.5 * (per_metre(0) + per_metre(1) - lever * per_metre(2)), 0.0);
  const double of_each_wheel = 0.25 * base.track_width * base.track_width * per_metre(2);
  return odometry::IncrementNoise{std::sqrt(std::max(along, of_each_wheel)), std::sqrt(along),
                                  std::sqrt(per_metre(2))};
}

}  // namespace odomcalib::calib::report
