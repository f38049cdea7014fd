#include "calib/tracing/horizon.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "calib/validation/folds.hpp"

namespace odomcalib::calib {
namespace {

constexpr double kBootstrapBlockSeconds = 30.0;
constexpr std::size_t kMinWindows = 10;
constexpr int kDraws = 1000;
constexpr unsigned kSeed = 19960612;
constexpr double kHeadingLever = 0.5;  ///< m

struct Window {
  Interval interval;
  Pose measured;
};

/// Windows of unbroken, well-matched pairs inside one fold, half overlapping.
std::vector<Window> windows_of(const FitData& data, std::size_t first, const std::vector<std::size_t>& folds,
                               const std::vector<bool>& trusted, std::size_t fold) {
  std::vector<Window> windows;
  for (std::size_t begin = 0; begin < data.pairs.size();) {
    Pose chained;
    std::size_t k = begin;
    std::size_t half = begin + 1;
    for (; k < data.pairs.size(); ++k) {
      const bool joined = k == begin || data.pairs[k].follows_previous;
      if (!joined || folds[first + k] != fold || !trusted[first + k]) break;
      chained = compose(chained, data.pairs[k].motion);
      const double elapsed = data.pairs[k].interval.end - data.pairs[begin].interval.begin;
      if (elapsed < kHorizonSeconds / 2.0) half = k + 1;
      if (elapsed >= kHorizonSeconds) {
        windows.push_back({{data.pairs[begin].interval.begin, data.pairs[k].interval.end}, chained});
        break;
      }
    }
    const bool complete = k < data.pairs.size() && !windows.empty() &&
                          windows.back().interval.begin == data.pairs[begin].interval.begin;
    begin = complete ? half : std::max(k, begin + 1);
  }
  return windows;
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / std::max(static_cast<double>(values.size()), 1.0));
}

double combined_square(const HorizonError& e, std::size_t k) {
  return e.position[k] * e.position[k] + std::pow(kHeadingLever * e.heading[k], 2);
}

}  // namespace

double HorizonError::rms_position() const { return rms(position); }
double HorizonError::rms_heading() const { return rms(heading); }

std::vector<bool> trusted_pairs(const FitResult& a, const FitResult& b) {
  constexpr double kTrustedWeight = 0.3;
  std::vector<bool> trusted;
  for (std::size_t k = 0; k < std::min(a.weights.size(), b.weights.size()); ++k)
    trusted.push_back(std::max(a.weights[k], b.weights[k]) >= kTrustedWeight);
  return trusted;
}

std::optional<HorizonError> horizon_error(std::span<const FitData> data, const EffectList& effects,
                                          const FitResult& fit, const std::vector<bool>& fixed,
                                          const std::vector<bool>& trusted) {
  const auto folds = folds_of(data);
  HorizonError error;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    const Eigen::VectorXd parameters = without_fold(fit, folds, fold, fixed);
    std::size_t first = 0;
    for (std::size_t d = 0; d < data.size(); ++d) {
      const auto windows = windows_of(data[d], first, folds, trusted, fold);
      first += data[d].pairs.size();
      std::vector<Interval> intervals;
      intervals.reserve(windows.size());
      for (const Window& w : windows) intervals.push_back(w.interval);
      const auto predicted = data[d].model->predict(as_span(parameters), effects, intervals);
      for (std::size_t k = 0; k < windows.size(); ++k) {
        error.position.push_back(
            std::hypot(predicted[k].x - windows[k].measured.x, predicted[k].y - windows[k].measured.y));
        error.heading.push_back(wrap_angle(predicted[k].yaw - windows[k].measured.yaw));
        error.fold.push_back(fold);
        error.block.push_back(1000 * d +
                              static_cast<std::size_t>(std::max(
                                  0.0, (windows[k].interval.begin - data[d].pairs.front().interval.begin) /
                                           kBootstrapBlockSeconds)));
      }
    }
  }
  if (error.position.size() < kMinWindows) return std::nullopt;
  return error;
}

HorizonError where_selected(const HorizonError& before, const HorizonError& after,
                            const FoldFlags& selected) {
  HorizonError mixed = before;
  const std::size_t count = std::min(before.position.size(), after.position.size());
  for (std::size_t k = 0; k < count; ++k) {
    if (!selected[before.fold[k]]) continue;
    mixed.position[k] = after.position[k];
    mixed.heading[k] = after.heading[k];
  }
  return mixed;
}

Improvement compare(const HorizonError& before, const HorizonError& after) {
  struct Sums {
    double before = 0.0;
    double after = 0.0;
  };
  std::map<std::size_t, Sums> by_block;
  const std::size_t count = std::min(before.position.size(), after.position.size());
  for (std::size_t k = 0; k < count; ++k) {
    by_block[before.block[k]].before += combined_square(before, k);
    by_block[before.block[k]].after += combined_square(after, k);
  }
  std::vector<Sums> blocks;
  blocks.reserve(by_block.size());
  for (const auto& [block, sums] : by_block) blocks.push_back(sums);
  const auto ratio = [](const Sums& s) { return std::sqrt(s.after / std::max(s.before, 1e-300)); };
  Sums total;
  for (const Sums& s : blocks) total = {total.before + s.before, total.after + s.after};
  std::mt19937 engine(kSeed);
  std::vector<double> ratios;
  for (int draw = 0; draw < kDraws; ++draw) {
    Sums sample;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const Sums& s = blocks[engine() % blocks.size()];
      sample = {sample.before + s.before, sample.after + s.after};
    }
    ratios.push_back(ratio(sample));
  }
  std::sort(ratios.begin(), ratios.end());
  return {ratio(total), ratios[static_cast<std::size_t>(0.975 * kDraws)],
          ratios[static_cast<std::size_t>(0.025 * kDraws)]};
}

HeldOutGain held_out_gain(std::span<const FitData> data, const FitResult& before,
                          const std::vector<bool>& fixed_before, const FitResult& after,
                          const std::vector<bool>& fixed_after, const FoldFlags& selected) {
  constexpr double kClipSquared = 3.5 * 3.5;
  const auto folds = folds_of(data);
  std::vector<double> gains(folds.size(), 0.0);
  const auto add = [&](const FitResult& fit, const std::vector<bool>& fixed, double sign) {
    for (std::size_t fold = 0; fold < kFolds; ++fold) {
      if (!selected[fold]) continue;
      const Eigen::VectorXd change = without_fold(fit, folds, fold, fixed) - fit.parameters;
      for (std::size_t k = 0; k < folds.size(); ++k) {
        if (folds[k] != fold) continue;
        const auto row = static_cast<Eigen::Index>(3 * k);
        const Eigen::Vector3d r =
            fit.whitened_residual.segment<3>(row) - fit.whitened_jacobian.middleRows<3>(row) * change;
        gains[k] += sign * r.cwiseAbs2().cwiseMin(kClipSquared).sum();
      }
    }
  };
  add(before, fixed_before, 1.0);
  add(after, fixed_after, -1.0);
  std::vector<double> blocks;
  std::size_t first = 0;
  for (const FitData& d : data) {
    double begin = -1e300;
    for (std::size_t k = 0; k < d.pairs.size(); ++k) {
      if (d.pairs[k].interval.begin > begin + kBootstrapBlockSeconds / 3.0) {
        blocks.push_back(0.0);
        begin = d.pairs[k].interval.begin;
      }
      blocks.back() += gains[first + k];
    }
    first += d.pairs.size();
  }
  HeldOutGain gain;
  for (const double b : blocks) gain.total += b;
  std::mt19937 engine(kSeed);
  std::vector<double> totals;
  for (int draw = 0; draw < kDraws; ++draw) {
    double total = 0.0;
    for (std::size_t b = 0; b < blocks.size(); ++b) total += blocks[engine() % blocks.size()];
    totals.push_back(total);
  }
  std::sort(totals.begin(), totals.end());
  gain.lower = totals[static_cast<std::size_t>(0.025 * kDraws)];
  return gain;
}

}  // namespace odomcalib::calib
