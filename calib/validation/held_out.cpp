#include "calib/validation/held_out.hpp"

#include <algorithm>
#include <vector>

#include "calib/estimation/fit.hpp"
#include "calib/estimation/stack.hpp"
#include "calib/math/vector2.hpp"
#include "calib/validation/folds.hpp"
#include "calib/validation/settings.hpp"

namespace odomcalib::calib::validation {
namespace {

/// In the sensor's frame at the begin: heading zero.
Eigen::Vector3d expected_variance(const measurement::SensorPair& pair, const measurement::NoiseModel& noise) {
  measurement::PairState state;
  const double duration = std::max(pair.interval.end - pair.interval.begin, 1e-3);
  state.begin_velocity = Eigen::Vector3d(pair.motion.x, pair.motion.y, pair.motion.yaw) / duration;
  state.end_velocity = state.begin_velocity;
  return full_covariance(pair, state, noise).diagonal();
}

bool is_gross(const HeldOutError& e) {
  return e.error.cwiseAbs2().cwiseQuotient(e.variance).maxCoeff() >
         settings::kGrossError * settings::kGrossError;
}

std::array<double, 3> root(const Eigen::Vector3d& sum, std::size_t count) {
  const Eigen::Vector3d r = (sum / static_cast<double>(count)).cwiseSqrt();
  return {r(0), r(1), r(2)};
}

}  // namespace

std::vector<HeldOutError> held_out_errors(std::span<const measurement::FitData> data,
                                          const vehicle::EffectList& effects,
                                          const estimation::FitResult& fit, const std::vector<bool>& fixed) {
  const auto folds = folds_of(data);
  if (!hold_out(folds)) return {};
  std::vector<HeldOutError> errors(folds.size());
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    const Eigen::VectorXd parameters = without_fold(fit, folds, fold, fixed);
    std::size_t first = 0;
    for (std::size_t d = 0; d < data.size(); ++d) {
      const auto& pairs = data[d].pairs;
      const auto predicted =
          data[d].model->predict(vehicle::as_span(parameters), effects, estimation::intervals_of(pairs));
      for (std::size_t k = 0; k < pairs.size(); ++k)
        if (folds[first + k] == fold)
          errors[first + k] = {math::difference(pairs[k].motion, predicted[k]),
                               expected_variance(pairs[k], fit.noise[d])};
      first += pairs.size();
    }
  }
  return errors;
}

std::optional<HeldOut> held_out_residual(const std::vector<HeldOutError>& errors,
                                         const std::vector<HeldOutError>& other) {
  Eigen::Vector3d squares = Eigen::Vector3d::Zero(), expected = squares, bounded = squares;
  std::size_t count = 0;
  for (std::size_t k = 0; k < std::min(errors.size(), other.size()); ++k) {
    bounded += errors[k].error.cwiseAbs2().cwiseMin(settings::kGrossError * settings::kGrossError *
                                                    errors[k].variance);
    if (is_gross(errors[k]) && is_gross(other[k])) continue;
    squares += errors[k].error.cwiseAbs2();
    expected += errors[k].variance;
    ++count;
  }
  if (count < settings::kFewestHeldOut) return std::nullopt;
  return HeldOut{root(squares, count), root(expected, count), root(bounded, errors.size()), count};
}

std::optional<HeldOut> held_out_residual(std::span<const measurement::FitData> data,
                                         const vehicle::EffectList& effects, const estimation::FitResult& fit,
                                         const std::vector<bool>& fixed) {
  const auto errors = held_out_errors(data, effects, fit, fixed);
  return held_out_residual(errors, errors);
}

std::optional<HeldOut> held_out_residual(const estimation::Fit& fit) {
  if (fit.failure) return std::nullopt;
  const auto& [effects, parameters] = fit.model;
  return held_out_residual(fit.dataset.data, effects, fit.result,
                           vehicle::fixed_with(fit.dataset.fixed(), effects));
}

}  // namespace odomcalib::calib::validation
