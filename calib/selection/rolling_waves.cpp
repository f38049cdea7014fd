#include "calib/selection/rolling_waves.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "calib/math/linear_solve.hpp"
#include "calib/selection/candidate_columns.hpp"
#include "calib/selection/score.hpp"
#include "calib/selection/settings.hpp"
#include "calib/terms/candidate_smooths.hpp"
#include "calib/terms/settings.hpp"
#include "calib/terms/smooth_term_on_drives.hpp"

namespace odomcalib::calib::selection {
namespace {

/// Something that repeats itself.
struct Repeating {
  vehicle::Dependence dependence;  ///< what its defect does
  double lowest, highest;          ///< frequencies that are sought, cycles per unit of the covariate
};

/// @param metre of the covariate, for a metre of way
Repeating rolling(const vehicle::Dependence& dependence, double metre) {
  return {dependence, 1.0 / (settings::kLongestRolling_m * metre),
          1.0 / (settings::kShortestRolling_m * metre)};
}

std::vector<Repeating> all_repeating(const vehicle::DriveModel& model, const estimation::FitResult& fit) {
  std::vector<Repeating> all{rolling({vehicle::Covariate::distance, vehicle::Channel::yaw_path}, 1.0),
                             rolling({vehicle::Covariate::left_phase, vehicle::Channel::left_travel},
                                     1.0 / fit.parameters(vehicle::kLeftRadius)),
                             rolling({vehicle::Covariate::right_phase, vehicle::Channel::right_travel},
                                     1.0 / fit.parameters(vehicle::kRightRadius))};
  const vehicle::DriveModel* const models[] = {&model};
  const auto [begin, end] = terms::range_of(vehicle::Covariate::time, models);
  const double tried = terms::settings::kMostCycles / (end - begin),
               shortest = 1.0 / terms::settings::kShortestCycle_s;
  if (tried < shortest)
    for (const vehicle::Channel channel : terms::kPeriodicChannels)
      all.push_back({{vehicle::Covariate::time, channel}, tried, shortest});
  return all;
}

/// Whitened derivatives of the residual by defects that are the same everywhere: waves without an end.
std::vector<Eigen::MatrixXd> steady_columns(std::span<const Repeating> all,
                                            std::span<const measurement::FitData> data,
                                            const FittedModel& model) {
  constexpr double kEndless = 1e12;
  std::vector<Candidate> steady;
  for (const Repeating& repeating : all)
    steady.push_back(candidate_of(on_basis({repeating.dependence, 0.0, 1.0}, terms::Cycle{kEndless})));
  return candidate_columns(data, model.effects, model.fit, steady);
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

/// Mean of the cosine and the sine over a window.
Eigen::Vector2d mean_wave(double begin, double end) {
  const double half = 0.5 * (end - begin), middle = 0.5 * (begin + end);
  const double damping = std::abs(half) < 1e-6 ? 1.0 : std::sin(half) / half;
  return {damping * std::cos(middle), damping * std::sin(middle)};
}

/// Sums over the measured motions from which the statistic of a wave follows.
struct WaveSums {
  Eigen::Vector2d score = Eigen::Vector2d::Zero();
  Eigen::Matrix2d gram = 1e-12 * Eigen::Matrix2d::Identity();

  /// Chi-squared with two degrees of freedom in noise.
  [[nodiscard]] double statistic(double variance) const {
    return score.dot(math::solve_symmetric(gram, score)) / variance;
  }
};

/// Some measured motions, as many as stay in the fastest memory.
using Few = Eigen::Array<double, 64, 1>;

/// A unit vector for each of some motions, which turns by the same angle from one frequency to the next.
class Turning {
 public:
  Turning(const Few& angle, const Few& step)
      : cos_(angle.cos()), sin_(angle.sin()), step_cos_(step.cos()), step_sin_(step.sin()) {}

  [[nodiscard]] const Few& cos() const { return cos_; }
  [[nodiscard]] const Few& sin() const { return sin_; }
  void turn() {
    const Few before = cos_;
    cos_ = before * step_cos_ - sin_ * step_sin_;
    sin_ = before * step_sin_ + sin_ * step_cos_;
  }

 private:
  Few cos_, sin_, step_cos_, step_sin_;
};

/// The evidence for a wave of each frequency.
class Periodogram {
 public:
  /// @param steady derivative by a defect that is the same everywhere, in its first column
  Periodogram(const Eigen::MatrixXd& steady, Rolled way, const Eigen::VectorXd& residual)
      : way_(std::move(way)), variance_(residual.squaredNorm() / static_cast<double>(residual.size())) {
    for (Eigen::Index k = 0; k < residual.size() / 3; ++k) {
      const auto column = steady.block<3, 1>(3 * k, 0);
      weight_.push_back(column.squaredNorm());
      score_.push_back(column.dot(residual.segment<3>(3 * k)));
    }
  }

  /// Chi-squared with two degrees of freedom in noise.
  /// @param frequency cycles per unit of the covariate
  [[nodiscard]] double statistic(double frequency) const {
    WaveSums sums;
    for (std::size_t k = 0; k < score_.size(); ++k) {
      const Eigen::Vector2d wave =
          mean_wave(2.0 * math::kPi * frequency * way_.begin[k], 2.0 * math::kPi * frequency * way_.end[k]);
      sums.score += score_[k] * wave;
      sums.gram += weight_[k] * wave * wave.transpose();
    }
    return sums.statistic(variance_);
  }

  /// The same at evenly spaced frequencies, by turning each motion's wave from one to the next: sines of
  /// every motion at every frequency would be most of the time of an hour's calibration.
  [[nodiscard]] std::vector<double> statistics(std::span<const double> frequencies) const {
    std::vector<WaveSums> sums(frequencies.size());
    const auto some = static_cast<std::size_t>(Few::RowsAtCompileTime);
    for (std::size_t first = 0; first < score_.size(); first += some) add(first, frequencies, sums);
    std::vector<double> out;
    out.reserve(sums.size());
    for (const WaveSums& of_one : sums) out.push_back(of_one.statistic(variance_));
    return out;
  }

 private:
  void add(std::size_t first, std::span<const double> frequencies, std::span<WaveSums> sums) const {
    Few begin = Few::Zero(), end = Few::Zero(), weight = Few::Zero(), score = Few::Zero();
    for (Eigen::Index k = 0; k < Few::RowsAtCompileTime && first < score_.size(); ++k, ++first) {
      begin(k) = way_.begin[first], end(k) = way_.end[first];
      weight(k) = weight_[first], score(k) = score_[first];
    }
    const double cycle = 2.0 * math::kPi, by = frequencies.size() > 1 ? frequencies[1] - frequencies[0] : 0.0;
    const Few middle = 0.5 * cycle * (begin + end), half = 0.5 * cycle * (end - begin);
    Turning at_middle(frequencies[0] * middle, by * middle), at_half(frequencies[0] * half, by * half);
    for (std::size_t i = 0; i < frequencies.size(); ++i, at_middle.turn(), at_half.turn()) {
      const Few angle = frequencies[i] * half;
      const Few damping = (angle.abs() < 1e-6).select(1.0, at_half.sin() / angle);
      const Few in_phase = damping * at_middle.cos(), in_quadrature = damping * at_middle.sin();
      const double mixed = (weight * in_phase * in_quadrature).sum();
      sums[i].score += Eigen::Vector2d((score * in_phase).sum(), (score * in_quadrature).sum());
      sums[i].gram += Eigen::Matrix2d{{(weight * in_phase.square()).sum(), mixed},
                                      {mixed, (weight * in_quadrature.square()).sum()}};
    }
  }

  Rolled way_;
  double variance_;
  std::vector<double> weight_, score_;
};

std::vector<double> frequencies_between(double low, double high, double by) {
  std::vector<double> frequencies;
  for (double f = low; f <= high; f += by) frequencies.push_back(f);
  return frequencies;
}

struct Peak {
  double frequency, statistic;
};

Peak highest_of(std::span<const double> frequencies, std::span<const double> statistics) {
  Peak highest{frequencies.front(), 0.0};
  for (std::size_t k = 0; k < frequencies.size(); ++k)
    if (statistics[k] > highest.statistic) highest = {frequencies[k], statistics[k]};
  return highest;
}

/// Frequency of the wave that stands out of all that are sought, between which settings::kRollingStep cycles
/// lie; its place in between a tenth as far.
std::optional<double> outstanding(const Repeating& repeating, const Periodogram& periodogram,
                                  double whole_way) {
  const double lowest = repeating.lowest, step = settings::kRollingStep / whole_way;
  if (!(step < lowest)) return std::nullopt;
  const double highest = std::min(repeating.highest, lowest + settings::kMostRolling * step);
  const std::vector<double> all = frequencies_between(lowest, highest, step);
  const double coarse = highest_of(all, periodogram.statistics(all)).frequency;
  const std::vector<double> close =
      frequencies_between(coarse - step, coarse + step, settings::kFineRollingStep * step);
  std::vector<double> statistics;
  statistics.reserve(close.size());
  for (const double frequency : close) statistics.push_back(periodogram.statistic(frequency));
  const Peak peak = highest_of(close, statistics);
  const double tried = settings::kTriedPerRollingStep * (highest - lowest) / step;
  return chi_squared_tail(peak.statistic, 2) * tried < settings::kDecisivePeak ? std::optional(peak.frequency)
                                                                               : std::nullopt;
}

/// Once round with each turn of a wheel has a name; it competes with the wave.
std::vector<Candidate> with_their_names(std::vector<Candidate> waves, const vehicle::EffectList& present) {
  const std::size_t count = waves.size();
  for (const Candidate& name : names_missing(present, true)) {
    const auto& dependences = name.effect->dependences();
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
  const vehicle::DriveModel* const models[] = {data.front().model};
  const std::vector<Repeating> all = all_repeating(*models[0], model.fit);
  const std::vector<Eigen::MatrixXd> steady = steady_columns(all, data, model);
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Rolled way = rolled(data.front(), all[k].dependence.covariate);
    if (const auto frequency = outstanding(all[k], Periodogram(steady[k], way, residual), way.all))
      candidates.push_back(candidate_of(as_of_the_drive(
          on_basis({all[k].dependence, 0.0, way.all}, terms::Cycle{1.0 / *frequency}), models)));
  }
  return with_their_names(std::move(candidates), model.effects);
}

}  // namespace odomcalib::calib::selection
