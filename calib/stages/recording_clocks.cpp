#include "calib/stages/recording_clocks.hpp"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "calib/math/pooled_estimates.hpp"
#include "calib/selection/score.hpp"
#include "calib/selection/settings.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/vehicle/step_twist.hpp"

namespace odomcalib::calib::stages {
namespace {

using vehicle::ClockPart;

constexpr std::array kParts = {ClockPart::offset, ClockPart::rate};
constexpr auto kClock = static_cast<Eigen::Index>(kParts.size());

/// Offset and rate of a sensor's clock against that of the encoders: s in the middle of the recording, s/s.
using Clock = Eigen::Vector2d;

Clock clock_of(const vehicle::VehicleModel& model) {
  Clock clock = Clock::Zero();
  for (Eigen::Index k = 0; k < kClock; ++k)
    if (const auto parameter = parameter_of(model.effects, kParts.at(static_cast<std::size_t>(k))))
      clock(k) = model.parameters(*parameter);
  return clock;
}

vehicle::VehicleModel with_both_parts(vehicle::VehicleModel model) {
  for (const ClockPart part : kParts) {
    if (place_of(model.effects, part)) continue;
    model.effects.push_back(terms::clock_effect(part));
    const auto known = model.parameters.size();
    const auto more = static_cast<Eigen::Index>(model.effects.back()->parameters().size());
    model.parameters.conservativeResize(known + more);
    model.parameters.tail(more).setZero();
  }
  return model;
}

/// The recording's own clock, everything else as all recordings have it.
std::optional<math::OwnValues> own_clock(const measurement::Dataset& dataset,
                                         const vehicle::VehicleModel& model, std::size_t recording) {
  estimation::FitOptions options;
  options.fixed.assign(static_cast<std::size_t>(model.parameters.size()), true);
  const std::array free = {*parameter_of(model.effects, kParts[0]), *parameter_of(model.effects, kParts[1])};
  for (const Eigen::Index k : free) options.fixed[static_cast<std::size_t>(k)] = false;
  const auto data = std::span<const measurement::FitData>(dataset.data).subspan(recording, 1);
  const auto fit = estimation::fit_joint(data, model.effects, model.parameters, options);
  if (!fit || fit.value().used <= static_cast<std::size_t>(kClock)) return std::nullopt;
  return math::OwnValues{recording, fit.value().parameters(free), fit.value().covariance(free, free),
                         static_cast<double>(fit.value().used) - static_cast<double>(kClock)};
}

std::vector<math::OwnValues> own_clocks(const estimation::Fit& fit) {
  const vehicle::VehicleModel model = with_both_parts(fit.model);
  std::vector<math::OwnValues> own;
  for (std::size_t i = 0; i < fit.dataset.data.size(); ++i)
    if (auto one = own_clock(fit.dataset, model, i)) own.push_back(std::move(*one));
  return own;
}

bool differ(const std::vector<math::OwnValues>& own) {
  if (own.size() < 2) return false;
  const double q = math::cochran(own);
  return std::isfinite(q) &&
         selection::chi_squared_tail(q, (own.size() - 1) * kParts.size()) < selection::settings::kClockLevel;
}

Eigen::Matrix2d between(const std::vector<math::OwnValues>& own) {
  return Clock(math::variance_between(own, 0), math::variance_between(own, 1)).asDiagonal();
}

/// The clock of each recording that has one of its own, as one of a population of them.
std::vector<Clock> shrunk(const std::vector<math::OwnValues>& own, const Eigen::Matrix2d& spread) {
  math::Pool pool(kClock);
  for (const math::OwnValues& one : own) pool.add(one.value, one.covariance + spread);
  const Clock mean = pool.value();
  std::vector<Clock> clocks;
  for (const math::OwnValues& one : own) {
    const Eigen::Matrix2d whole = spread + one.covariance;
    clocks.emplace_back(mean + spread * whole.inverse() * (one.value - mean));
  }
  return clocks;
}

template <typename Sample>
void restamp(std::vector<Sample>& samples, const Clock& apart, double middle) {
  for (Sample& sample : samples) sample.t -= apart(0) + apart(1) * (sample.t - middle);
}

}  // namespace

estimation::Fit align_clocks(estimation::Fit fit, const terms::Request& request,
                             const estimation::Settling& how) {
  const measurement::Dataset& dataset = fit.dataset;
  if (fit.failure || !request.is_automatic || dataset.has_motions_alone() || dataset.data.size() < 2)
    return fit;
  const std::vector<math::OwnValues> own = own_clocks(fit);
  if (!differ(own)) return fit;
  const Eigen::Matrix2d spread = between(own);
  // Rates alone that differ are no clocks set anew: crystals of one robot do not.
  if (!(spread(0, 0) > 0.0)) return fit;
  const std::vector<Clock> clocks = shrunk(own, spread);
  const Clock common = clock_of(fit.model);
  ingest::Repairs repairs(dataset.recordings.view());
  for (std::size_t k = 0; k < own.size(); ++k) {
    const std::size_t i = own[k].recording;
    const double middle = vehicle::middle_of(dataset.models[i]->track());
    restamp(repairs.own(i).poses, clocks[k] - common, middle);
    restamp(repairs.own(i).scans, clocks[k] - common, middle);
  }
  ingest::StampReport stamps = dataset.recordings.stamps();
  stamps.clocks = std::sqrt(spread(0, 0));
  const ingest::Recordings aligned = std::move(repairs).take(stamps);
  return measure_and_settle(with_scans_of(std::move(fit.dataset), aligned), std::move(fit.model), how);
}

}  // namespace odomcalib::calib::stages
