#include "calib/validation/window_errors.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "calib/math/bootstrap.hpp"
#include "calib/math/settings.hpp"
#include "calib/validation/folds.hpp"
#include "calib/validation/settings.hpp"

namespace odomcalib::calib::validation {
namespace {

constexpr unsigned kWindowSeed = 19960612;

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / std::max(static_cast<double>(values.size()), 1.0));
}

double combined_square(const WindowErrors& e, std::size_t k) {
  return e.position[k] * e.position[k] + std::pow(settings::kHeadingLever_m * e.heading[k], 2);
}

std::vector<EvaluationWindow> select(const std::vector<EvaluationWindow>& windows, std::size_t fold,
                                     std::size_t recording) {
  std::vector<EvaluationWindow> selected;
  std::copy_if(windows.begin(), windows.end(), std::back_inserter(selected),
               [&](const EvaluationWindow& s) { return s.fold == fold && s.recording == recording; });
  return selected;
}

void add_errors(const measurement::FitData& data, const Eigen::VectorXd& parameters,
                const vehicle::EffectList& effects, const std::vector<EvaluationWindow>& windows,
                WindowErrors& error) {
  if (windows.empty()) return;
  const vehicle::Trajectory trajectory = data.model->trajectory(vehicle::as_span(parameters), effects);
  const measurement::PathOfWheels wheels = measurement::path_of_wheels(trajectory);
  for (const EvaluationWindow& window : windows) {
    const math::Pose predicted = between(wheels(window.interval.begin), wheels(window.interval.end));
    const math::Pose measured = measured_motion(window, data, wheels);
    error.position.push_back(std::hypot(predicted.x - measured.x, predicted.y - measured.y));
    error.heading.push_back(math::wrap_angle(predicted.yaw - measured.yaw));
    error.fold.push_back(window.fold);
    error.block.push_back(window.block);
  }
}

}  // namespace

double WindowErrors::rms_position() const { return rms(position); }

WindowErrors window_errors(std::span<const measurement::FitData> data,
                           const std::vector<EvaluationWindow>& windows, const vehicle::EffectList& effects,
                           const estimation::FitResult& fit, const std::vector<bool>& fixed) {
  const auto folds = folds_of(data);
  WindowErrors error;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    const Eigen::VectorXd parameters = without_fold(fit, folds, fold, fixed);
    for (std::size_t d = 0; d < data.size(); ++d)
      add_errors(data[d], parameters, effects, select(windows, fold, d), error);
  }
  return error;
}

WindowErrors where_selected(const WindowErrors& before, const WindowErrors& after,
                            const FoldFlags& selected) {
  WindowErrors mixed = before;
  const std::size_t count = std::min(before.position.size(), after.position.size());
  for (std::size_t k = 0; k < count; ++k) {
    if (!selected[before.fold[k]]) continue;
    mixed.position[k] = after.position[k];
    mixed.heading[k] = after.heading[k];
  }
  return mixed;
}

bool Improvement::is_plain() const {
  if (upper < 1.0) return true;
  const double deviation = std::log(upper / lower) / (2.0 * settings::kNormal95);
  return std::log(ratio) + settings::kPlainGain * deviation < 0.0;
}

Improvement compare(const WindowErrors& before, const WindowErrors& after) {
  std::map<std::size_t, math::RatioOfSums> by_block;
  const std::size_t count = std::min(before.position.size(), after.position.size());
  for (std::size_t k = 0; k < count; ++k)
    by_block[before.block[k]] += {combined_square(after, k), combined_square(before, k)};
  const math::BootstrapInterval interval = bootstrap_root(by_block, kWindowSeed);
  return {total_of(by_block).root(), interval.upper, interval.lower};
}

HeldOutGain held_out_gain(std::span<const measurement::FitData> data, const estimation::FitResult& before,
                          const std::vector<bool>& fixed_before, const estimation::FitResult& after,
                          const std::vector<bool>& fixed_after, const FoldFlags& selected) {
  constexpr double kClipSquared = settings::kClip * settings::kClip;
  const auto folds = folds_of(data);
  std::vector<double> gains(folds.size(), 0.0);
  const auto add = [&](const estimation::FitResult& fit, const std::vector<bool>& fixed, double sign) {
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
  for (const measurement::FitData& d : data) {
    double begin = -1e300;
    for (std::size_t k = 0; k < d.pairs.size(); ++k) {
      if (d.pairs[k].interval.begin > begin + math::settings::kBlock_s) {
        blocks.push_back(0.0);
        begin = d.pairs[k].interval.begin;
      }
      blocks.back() += gains[first + k];
    }
    first += d.pairs.size();
  }
  HeldOutGain gain;
  for (const double b : blocks) gain.total += b;
  gain.lower = math::bootstrap(blocks, kWindowSeed, [](double sum) { return sum; }).lower;
  return gain;
}

}  // namespace odomcalib::calib::validation
