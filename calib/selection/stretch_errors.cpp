#include "calib/selection/stretch_errors.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "calib/math/bootstrap.hpp"
#include "calib/selection/folds.hpp"
#include "calib/selection/settings.hpp"

namespace odomcalib::calib::selection {
namespace {

constexpr unsigned kSeed = 19960612;
constexpr double kHeadingLever = 0.5;  ///< m

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / std::max(static_cast<double>(values.size()), 1.0));
}

double combined_square(const StretchErrors& e, std::size_t k) {
  return e.position[k] * e.position[k] + std::pow(kHeadingLever * e.heading[k], 2);
}

std::vector<Stretch> select(const std::vector<Stretch>& stretches, std::size_t fold, std::size_t recording) {
  std::vector<Stretch> selected;
  std::copy_if(stretches.begin(), stretches.end(), std::back_inserter(selected),
               [&](const Stretch& s) { return s.fold == fold && s.recording == recording; });
  return selected;
}

void add_errors(const measurement::FitData& data, const Eigen::VectorXd& parameters,
                const vehicle::EffectList& effects, const std::vector<Stretch>& stretches,
                StretchErrors& error) {
  if (stretches.empty()) return;
  const vehicle::Trajectory trajectory = data.model->trajectory(vehicle::as_span(parameters), effects);
  const measurement::PathOfWheels wheels = measurement::path_of_wheels(trajectory);
  for (const Stretch& stretch : stretches) {
    const math::Pose predicted = between(wheels(stretch.interval.begin), wheels(stretch.interval.end));
    const math::Pose measured = measured_motion(stretch, data, wheels);
    error.position.push_back(std::hypot(predicted.x - measured.x, predicted.y - measured.y));
    error.heading.push_back(math::wrap_angle(predicted.yaw - measured.yaw));
    error.fold.push_back(stretch.fold);
    error.block.push_back(stretch.block);
  }
}

}  // namespace

double StretchErrors::rms_position() const { return rms(position); }
double StretchErrors::rms_heading() const { return rms(heading); }

StretchErrors stretch_errors(std::span<const measurement::FitData> data,
                             const std::vector<Stretch>& stretches, const vehicle::EffectList& effects,
                             const estimation::FitResult& fit, const std::vector<bool>& fixed) {
  const auto folds = folds_of(data);
  StretchErrors error;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    const Eigen::VectorXd parameters = without_fold(fit, folds, fold, fixed);
    for (std::size_t d = 0; d < data.size(); ++d)
      add_errors(data[d], parameters, effects, select(stretches, fold, d), error);
  }
  return error;
}

StretchErrors where_selected(const StretchErrors& before, const StretchErrors& after,
                             const FoldFlags& selected) {
  StretchErrors mixed = before;
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
  constexpr double kBothSides = 2.0 * 1.960, kOneSide = 1.282;  // normal quantiles, 95 % and 90 %
  const double deviation = std::log(upper / lower) / kBothSides;
  return std::log(ratio) + kOneSide * deviation < 0.0;
}

Improvement compare(const StretchErrors& before, const StretchErrors& after) {
  std::map<std::size_t, math::RatioOfSums> by_block;
  const std::size_t count = std::min(before.position.size(), after.position.size());
  for (std::size_t k = 0; k < count; ++k)
    by_block[before.block[k]] += {combined_square(after, k), combined_square(before, k)};
  const math::BootstrapInterval interval = bootstrap_root(by_block, kSeed);
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
      if (d.pairs[k].interval.begin > begin + settings::kGainBlock_s) {
        blocks.push_back(0.0);
        begin = d.pairs[k].interval.begin;
      }
      blocks.back() += gains[first + k];
    }
    first += d.pairs.size();
  }
  HeldOutGain gain;
  for (const double b : blocks) gain.total += b;
  gain.lower = math::bootstrap(blocks, kSeed, [](double sum) { return sum; }).lower;
  return gain;
}

}  // namespace odomcalib::calib::selection
