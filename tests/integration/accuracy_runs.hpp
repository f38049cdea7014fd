// Simulated drives solved and set beside their truth and beside the bound of their range readings.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "calib/solve.hpp"
#include "tests/sim/world/ray_bound.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib::test_support {

/// RMS error over the bound that is asked for.
inline constexpr double kRatioBar = 1.3;

struct AccuracyCase {
  sim::SimulationConfig config;
  sim::SimulatedRun run;
};

/// Four minutes of the guided pattern in a furnished room: 8 mm range noise, 50 Hz ticks, 10 Hz lidar.
inline AccuracyCase four_minutes(std::uint64_t seed) {
  AccuracyCase made{sim::standard_config(seed), {}};
  made.config.duration = 240.0;
  made.run = sim::simulate_recording(made.config, sim::follow(made.config.nominal, sim::guided_pattern()));
  return made;
}

/// Errors of both diameters and the track width in stated deviations.
inline std::array<double, 3> length_errors_in_sigmas(const Calibration& result, const sim::Geometry& truth) {
  const std::array<double, 3> values = {truth.left_diameter, truth.right_diameter, truth.track_width};
  std::array<double, 3> errors{};
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const Quantity& q = result.parameters[k].second;
    errors[k] = (q.value - values[k]) / q.std;
  }
  return errors;
}

/// Whether a name, one that the data cannot tell from it, or a variable is told.
inline bool is_told(const Calibration& result, const std::string& name) {
  const auto holds = [&](const std::vector<std::string>& list) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  return std::any_of(result.effects.begin(), result.effects.end(),
                     [&](const EffectResult& e) { return e.name == name || holds(e.aliases); }) ||
         (result.unexplained && holds(result.unexplained->depends_on));
}

/// Names and variables, for messages.
inline std::string told(const Calibration& result) {
  std::string out = "told:";
  for (const EffectResult& effect : result.effects) out += " " + effect.name;
  if (result.unexplained)
    for (const std::string& variable : result.unexplained->depends_on) out += " f(" + variable + ")";
  return out;
}

class AccuracyTable {
 public:
  /// Solves a run; empty, or what is odd about it.
  std::string add(const AccuracyCase& made, const std::string& effects) {
    calib::SolveOptions options;
    options.effects = {effects};
    const std::clock_t begin = std::clock();
    const Calibration result = calib::solve({&made.run.recording, 1}, options);
    seconds_ += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    if (result.verdict == Verdict::refused) return "refused: " + result.reasons[0];
    enter(result, made);
    std::string odd;
    for (const EffectResult& effect : result.effects) odd += "found " + effect.name + " ";
    if (result.unexplained) odd += "found a curve";
    return odd;
  }

  [[nodiscard]] double ratio(std::size_t k) const { return std::sqrt(squares_[k] / bounds_[k]); }
  [[nodiscard]] double worst_ratio() const {
    double worst = 0.0;
    for (std::size_t k = 0; k < sim::kLearned; ++k) worst = std::max(worst, ratio(k));
    return worst;
  }
  /// RMS over the parameters.
  [[nodiscard]] double pooled_ratio() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < sim::kLearned; ++k) sum += ratio(k) * ratio(k) / sim::kLearned;
    return std::sqrt(sum);
  }
  /// Share of truths inside the 95 % intervals over all parameters.
  [[nodiscard]] double coverage() const {
    double inside = 0.0;
    for (const double count : inside_) inside += count;
    return inside / (sim::kLearned * static_cast<double>(runs_));
  }
  [[nodiscard]] bool is_honest() const { return coverage() >= 0.92 && coverage() <= 0.98; }
  [[nodiscard]] std::size_t runs() const { return runs_; }
  [[nodiscard]] double relative_rms(std::size_t k) const { return std::sqrt(relative_[k] / count()); }

  void print() const {
    static constexpr std::array<const char*, sim::kLearned> kNames = {
        "left diameter", "right diameter", "track width", "lidar x", "lidar y", "lidar yaw"};
    std::printf("%zu runs, %.2f s CPU each\n%-15s %10s %10s %10s %7s %7s %7s\n", runs_, seconds_ / count(),
                "mm, mrad", "mean", "RMS", "bound", "ratio", "sigmas", "in 95 %");
    for (std::size_t k = 0; k < sim::kLearned; ++k)
      std::printf("%-15s %10.4f %10.4f %10.4f %7.2f %7.2f %7.0f\n", kNames[k], 1e3 * means_[k] / count(),
                  1e3 * std::sqrt(squares_[k] / count()), 1e3 * std::sqrt(bounds_[k] / count()), ratio(k),
                  std::sqrt(sigmas_[k] / count()), 100.0 * inside_[k] / count());
    std::printf("95 %% intervals hold %.1f %% of the truths\n", 100.0 * coverage());
  }

 private:
  [[nodiscard]] double count() const { return static_cast<double>(runs_); }

  void enter(const Calibration& result, const AccuracyCase& made) {
    const sim::Geometry& g = made.run.truth;
    const std::array<double, sim::kLearned> truth = {g.left_diameter, g.right_diameter, g.track_width,
                                                     g.lidar.x,       g.lidar.y,        g.lidar.yaw};
    const auto bound = sim::ray_bound(made.config, made.run);
    ++runs_;
    for (std::size_t k = 0; k < sim::kLearned; ++k) {
      const Quantity& q = result.parameters[k].second;
      const double error = q.value - truth[k];
      means_[k] += error;
      squares_[k] += error * error;
      relative_[k] += std::pow(error / truth[k], 2);
      bounds_[k] += bound[k] * bound[k];
      sigmas_[k] += std::pow(error / q.std, 2);
      if (std::abs(error) < 1.96 * q.std) ++inside_[k];
    }
  }

  std::size_t runs_ = 0;
  double seconds_ = 0.0;
  std::array<double, sim::kLearned> means_{}, squares_{}, relative_{}, bounds_{}, sigmas_{}, inside_{};
};

}  // namespace odomcalib::test_support
