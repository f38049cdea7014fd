#include "calib/validation/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calib/estimators/stack.hpp"
#include "calib/geometry/vector2.hpp"
#include "calib/validation/folds.hpp"

namespace odomcalib::calib {
namespace {

constexpr std::size_t kMinPairs = 50;
constexpr double kGrossError = 6.0;  ///< sigma; a failed match says nothing about the wheels

/// Pairs of one fold, or of all others; a pair next to the border keeps no link across it.
std::vector<FitData> select(std::span<const FitData> data, const std::vector<std::size_t>& folds,
                            std::size_t fold, bool inside) {
  std::vector<FitData> selected;
  std::size_t first = 0;
  for (std::size_t d = 0; d < data.size(); ++d) {
    FitData part{data[d].model, {}};
    bool previous_kept = false;
    for (std::size_t k = 0; k < data[d].pairs.size(); ++k) {
      const bool keep = (folds[first + k] == fold) == inside;
      if (keep) {
        part.pairs.push_back(data[d].pairs[k]);
        part.pairs.back().follows_previous = part.pairs.back().follows_previous && previous_kept;
      }
      previous_kept = keep;
    }
    first += data[d].pairs.size();
    selected.push_back(std::move(part));
  }
  return selected;
}

struct Sums {
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  Eigen::Vector3d expected = Eigen::Vector3d::Zero();
  std::size_t count = 0;
};

/// In the sensor's frame at the begin: heading zero.
Eigen::Vector3d expected_variance(const SensorPair& pair, const NoiseModel& noise) {
  PairState state;
  const double duration = std::max(pair.interval.end - pair.interval.begin, 1e-3);
  state.begin_velocity = Eigen::Vector3d(pair.motion.x, pair.motion.y, pair.motion.yaw) / duration;
  state.end_velocity = state.begin_velocity;
  return full_covariance(pair, state, noise).diagonal();
}

void accumulate(const FitData& part, const Eigen::VectorXd& parameters, const EffectList& effects,
                const NoiseModel& noise, Sums& sums) {
  const auto predicted = part.model->predict(as_span(parameters), effects, intervals_of(part.pairs));
  for (std::size_t k = 0; k < part.pairs.size(); ++k) {
    const Eigen::Vector3d e = difference(part.pairs[k].motion, predicted[k]);
    const Eigen::Vector3d v = expected_variance(part.pairs[k], noise);
    if ((e.cwiseAbs2().cwiseQuotient(v)).maxCoeff() > kGrossError * kGrossError) continue;
    sums.squares += e.cwiseAbs2();
    sums.expected += v;
    ++sums.count;
  }
}

std::array<double, 3> root(const Eigen::Vector3d& sum, std::size_t count) {
  const Eigen::Vector3d r = (sum / static_cast<double>(count)).cwiseSqrt();
  return {r(0), r(1), r(2)};
}

}  // namespace

std::optional<HeldOut> held_out_residual(std::span<const FitData> data, const EffectList& effects,
                                         const FitResult& fit, const std::vector<bool>& fixed) {
  const auto folds = folds_of(data);
  Sums sums;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    const auto training = select(data, folds, fold, false);
    const auto test = select(data, folds, fold, true);
    FitOptions options;
    options.fixed = fixed;
    options.noise = fit.noise;
    options.max_iterations = 20;
    const auto trained = fit_joint(training, effects, fit.parameters, options);
    if (!trained) return std::nullopt;
    for (std::size_t d = 0; d < test.size(); ++d)
      accumulate(test[d], trained.value().parameters, effects, fit.noise[d], sums);
  }
  if (sums.count < kMinPairs) return std::nullopt;
  return HeldOut{root(sums.squares, sums.count), root(sums.expected, sums.count), sums.count};
}

}  // namespace odomcalib::calib
