#include "calib/selection/rolling_waves.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "calib/selection/candidate_columns.hpp"
#include "calib/selection/score.hpp"
#include "calib/selection/settings.hpp"

namespace odomcalib::calib::selection {
namespace {

/// Something that rolls.
struct Roller {
  vehicle::Dependence dependence;  ///< what its defect does
  double metre;                    ///< of its covariate, for a metre of way
};

std::array<Roller, 3> rollers(const estimation::FitResult& fit) {
  return {{{{vehicle::Covariate::distance, vehicle::Channel::yaw_path}, 1.0},
           {{vehicle::Covariate::left_phase, vehicle::Channel::left_travel},
            1.0 / fit.parameters(vehicle::kLeftRadius)},
           {{vehicle::Covariate::right_phase, vehicle::Channel::right_travel},
            1.0 / fit.parameters(vehicle::kRightRadius)}}};
}

/// Whitened derivative of the residual by a defect that is the same everywhere: a wave without an end.
Eigen::VectorXd steady_column(const vehicle::Dependence& dependence,
                              std::span<const measurement::FitData> data, const FittedModel& model) {
  constexpr double kEndless = 1e12;
  const std::vector<Candidate> steady{candidate_of(on_basis({dependence, 0.0, 1.0}, terms::Cycle{kEndless}))};
  return candidate_columns(data, model.effects, model.fit, steady).front().col(0);
}

/// How far something has rolled when each measured motion begins and ends.
struct Rolled {
  std::vector<double> begin, end;
  double all = 0.0;
};

Rolled rolled(const measurement::FitData& data, vehicle::Covariate covariate) {
  Rolled out;
  for (const measurement::SensorPair& pair : data.pairs) {
    const auto context = data.model->context_within(pair.interval);
    out.begin.push_back(value_of(covariate, context.front()));
    out.end.push_back(value_of(covariate, context.back()));
    out.all += std::abs(out.end.back() - out.begin.back());
  }
  return out;
}

/// Mean of the cosine and the sine over a stretch.
Eigen::Vector2d mean_wave(double begin, double end) {
  const double half = 0.5 * (end - begin), middle = 0.5 * (begin + end);
  const double damping = std::abs(half) < 1e-6 ? 1.0 : std::sin(half) / half;
  return {damping * std::cos(middle), damping * std::sin(middle)};
}

/// What a wave of each frequency would explain.
class Periodogram {
 public:
  /// @param steady column of the derivative by a defect that is the same everywhere
  Periodogram(const Eigen::VectorXd& steady, Rolled way, const Eigen::VectorXd& residual)
      : way_(std::move(way)), variance_(residual.squaredNorm() / static_cast<double>(residual.size())) {
    for (Eigen::Index k = 0; k < residual.size() / 3; ++k) {
      const auto column = steady.segment<3>(3 * k);
      weight_.push_back(column.squaredNorm());
      score_.push_back(column.dot(residual.segment<3>(3 * k)));
    }
  }

  /// Chi-squared with two degrees of freedom in noise.
  /// @param frequency cycles per unit of the covariate
  [[nodiscard]] double statistic(double frequency) const {
    Eigen::Vector2d score = Eigen::Vector2d::Zero();
    Eigen::Matrix2d gram = 1e-12 * Eigen::Matrix2d::Identity();
    for (std::size_t k = 0; k < score_.size(); ++k) {
      const Eigen::Vector2d wave =
          mean_wave(2.0 * math::kPi * frequency * way_.begin[k], 2.0 * math::kPi * frequency * way_.end[k]);
      score += score_[k] * wave;
      gram += weight_[k] * wave * wave.transpose();
    }
    return score.dot(gram.ldlt().solve(score)) / variance_;
  }

 private:
  Rolled way_;
  double variance_;
  std::vector<double> weight_, score_;
};

/// Frequency of the wave that stands out of all that a roller may make, between which settings::kRollingStep
/// cycles lie; its place in between a tenth as far.
/// @param metre of the covariate, for a metre of way
std::optional<double> outstanding(double metre, const Periodogram& periodogram, double whole_way) {
  const double lowest = 1.0 / (settings::kLongestRolling_m * metre),
               step = settings::kRollingStep / whole_way;
  if (!(step < lowest)) return std::nullopt;
  const double highest =
      std::min(1.0 / (settings::kShortestRolling_m * metre), lowest + settings::kMostRolling * step);
  const auto best_of = [&](double low, double high, double by) {
    std::array<double, 2> best{low, 0.0};
    for (double f = low; f <= high; f += by)
      if (const double s = periodogram.statistic(f); s > best[1]) best = {f, s};
    return best;
  };
  const double coarse = best_of(lowest, highest, step)[0];
  const auto [frequency, statistic] =
      best_of(coarse - step, coarse + step, settings::kFineRollingStep * step);
  const double tried = settings::kTriedPerRollingStep * (highest - lowest) / step;
  return chi_squared_tail(statistic, 2) * tried < settings::kDecisivePeak ? std::optional(frequency)
                                                                          : std::nullopt;
}

/// Once round with each turn of a wheel has a name; it competes with the wave.
std::vector<Candidate> with_their_names(std::vector<Candidate> waves, const vehicle::EffectList& present) {
  const std::size_t count = waves.size();
  for (const Candidate& name : names_missing(present, true)) {
    const auto dependences = name.effect->dependences();
    const auto is_its = [&](const Candidate& wave) { return contains(dependences, wave.smooth->dependence); };
    const auto end = waves.begin() + static_cast<std::ptrdiff_t>(count);
    if (std::any_of(waves.begin(), end, is_its)) waves.push_back(name);
  }
  return waves;
}

}  // namespace

std::vector<Candidate> rolling_waves(std::span<const measurement::FitData> data, const FittedModel& model) {
  std::vector<Candidate> candidates;
  if (data.size() != 1) return candidates;
  const Eigen::VectorXd residual = clipped(model.fit.whitened_residual);
  for (const Roller& roller : rollers(model.fit)) {
    const Rolled way = rolled(data.front(), roller.dependence.covariate);
    const Periodogram periodogram(steady_column(roller.dependence, data, model), way, residual);
    const auto frequency = outstanding(roller.metre, periodogram, way.all);
    if (frequency)
      candidates.push_back(
          candidate_of(on_basis({roller.dependence, 0.0, way.all}, terms::Cycle{1.0 / *frequency})));
  }
  return with_their_names(std::move(candidates), model.effects);
}

}  // namespace odomcalib::calib::selection
