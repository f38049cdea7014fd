#include "calib/report/report_data.hpp"

#include <algorithm>
#include <cmath>

#include "calib/math/median.hpp"
#include "calib/report/report.hpp"
#include "calib/report/residual_trace.hpp"
#include "calib/report/scan_overlay.hpp"
#include "calib/report/settings.hpp"
#include "calib/validation/drive_error.hpp"
#include "calib/validation/folds.hpp"
#include "calib/validation/settings.hpp"

namespace odomcalib::calib::report {
namespace {

std::size_t stride(std::size_t count, std::size_t most) {
  return std::max<std::size_t>(1, (count + most - 1) / most);
}

PathTrace path_of(const std::string& name, const std::vector<math::Pose>& poses) {
  PathTrace path{name, {}};
  const std::size_t step = stride(poses.size(), settings::kMostPathPoints);
  for (std::size_t k = 0; k < poses.size(); k += step)
    path.points.push_back({poses[k].x, poses[k].y, poses[k].yaw});
  return path;
}

/// Base poses by the reference: measured motions in a chain; gaps are bridged by the calibrated odometry.
std::vector<math::Pose> reference_path(const measurement::FitData& data,
                                       const vehicle::Trajectory& calibrated, const math::Pose& mount) {
  std::vector<math::Pose> poses;
  for (const measurement::SensorPair& pair : data.pairs) {
    if (poses.empty()) poses.push_back(calibrated.at(pair.interval.begin));
    if (!pair.follows_previous && poses.size() > 1) {
      const double since = (&pair - 1)->interval.end;
      poses.push_back(
          compose(poses.back(), between(calibrated.at(since), calibrated.at(pair.interval.begin))));
    }
    poses.push_back(compose(poses.back(), conjugate(pair.motion, inverse(mount))));
  }
  return poses;
}

/// The recording with the most to see. Tuples of separate motions make no path.
std::vector<PathTrace> paths_of(const measurement::Dataset& dataset, const vehicle::EffectList& effects,
                                const estimation::FitResult& fit) {
  const auto& data = dataset.data;
  if (dataset.has_motions_alone()) return {};
  const auto longest = std::max_element(
      data.begin(), data.end(), [](const auto& a, const auto& b) { return a.pairs.size() < b.pairs.size(); });
  const Eigen::VectorXd nominal = validation::with_wheels(fit.parameters, effects, dataset.nominal);
  const vehicle::Trajectory calibrated =
      longest->model->trajectory(vehicle::as_span(fit.parameters), effects);
  const math::Pose mount = vehicle::to_base(vehicle::as_span(fit.parameters)).mount;
  return {path_of("odometry", longest->model->trajectory(vehicle::as_span(nominal), effects).poses()),
          path_of("calibrated", calibrated.poses()),
          path_of("reference", reference_path(*longest, calibrated, mount))};
}

/// Normalised residuals of one axis, without the pairs that the fit does not trust.
std::vector<double> sigmas_of(const estimation::FitResult& fit, Eigen::Index axis) {
  std::vector<double> sigmas;
  for (std::size_t k = 0; k < fit.weights.size(); ++k)
    if (fit.weights[k] >= validation::settings::kTrustedWeight)
      sigmas.push_back(fit.whitened_residual(static_cast<Eigen::Index>(3 * k) + axis));
  return sigmas;
}

double mean_product(const std::vector<double>& values, std::size_t lag) {
  double sum = 0.0;
  for (std::size_t k = lag; k < values.size(); ++k) sum += values[k] * values[k - lag];
  return sum / std::max(static_cast<double>(values.size()), 1.0);
}

/// Wald and Wolfowitz's runs test on the signs: standard normal when their order is random.
double runs_test(const std::vector<double>& values) {
  double positive = 0.0;
  double runs = values.empty() ? 0.0 : 1.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (values[k] > 0.0) ++positive;
    if (k > 0 && (values[k] > 0.0) != (values[k - 1] > 0.0)) ++runs;
  }
  const double n = static_cast<double>(values.size());
  const double product = 2.0 * positive * (n - positive);
  if (n < settings::kFewestForRuns || product <= n) return 0.0;
  const double variance = product * (product - n) / (n * n * (n - 1.0));
  return (runs - (product / n + 1.0)) / std::sqrt(variance);
}

std::vector<std::size_t> histogram_of(const std::vector<double>& sigmas) {
  std::vector<std::size_t> counts(settings::kHistogramBins, 0);
  for (const double s : sigmas) {
    const double place = (s + settings::kHistogramEnd) / (2.0 * settings::kHistogramEnd) *
                         static_cast<double>(settings::kHistogramBins);
    if (place >= 0.0 && place < static_cast<double>(settings::kHistogramBins))
      ++counts[static_cast<std::size_t>(place)];
  }
  return counts;
}

ResidualAxis axis_of(const estimation::FitResult& fit, Eigen::Index axis, const char* name,
                     const char* unit) {
  ResidualAxis out;
  out.name = name;
  out.unit = unit;
  double count = 0.0;
  double squares = 0.0;
  for (std::size_t k = 0; k < fit.weights.size(); ++k) {
    if (fit.weights[k] < validation::settings::kTrustedWeight) continue;
    const double r = fit.residuals(static_cast<Eigen::Index>(k), axis);
    out.mean += r;
    squares += r * r;
    ++count;
  }
  out.mean /= std::max(count, 1.0);
  out.std = std::sqrt(std::max(squares / std::max(count, 1.0) - out.mean * out.mean, 0.0));
  const auto sigmas = sigmas_of(fit, axis);
  const double power = mean_product(sigmas, 0);
  out.normalised = std::sqrt(power);
  out.autocorrelation = power > 0.0 ? mean_product(sigmas, 1) / power : 0.0;
  out.runs = runs_test(sigmas);
  out.histogram = histogram_of(sigmas);
  return out;
}

/// Adds the final model's noise: the errors that it expects of measurements and wheels, axis by axis.
void add_noise(const measurement::Dataset& dataset, const estimation::FitResult& fit,
               std::vector<ResidualAxis>& axes) {
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    const auto row = static_cast<Eigen::Index>(axis);
    std::vector<double> reference, wheels;
    std::size_t k = 0;
    for (std::size_t i = 0; i < dataset.data.size(); ++i) {
      const measurement::NoiseModel& noise = fit.noise[i];
      for (const measurement::SensorPair& pair : dataset.data[i].pairs) {
        if (fit.weights[k++] < validation::settings::kTrustedWeight) continue;
        reference.push_back(noise.matcher_scale * std::sqrt(pair.covariance(row, row)));
        wheels.push_back(axis < 2 ? noise.process_translation : noise.process_rotation);
      }
    }
    if (reference.empty()) continue;
    axes[axis].reference_std = math::median_of(std::move(reference));
    axes[axis].wheels_std = math::median_of(std::move(wheels));
  }
}

/// Residuals of the first recording, over its time.
std::vector<ResidualSample> series_of(const measurement::Dataset& dataset, const estimation::FitResult& fit) {
  std::vector<ResidualSample> series;
  const auto& pairs = dataset.data.front().pairs;
  const std::size_t step = stride(pairs.size(), settings::kMostSamples);
  for (std::size_t k = 0; k < pairs.size(); k += step) {
    const auto row = static_cast<Eigen::Index>(3 * k);
    series.push_back(
        {pairs[k].interval.begin - pairs.front().interval.begin,
         {fit.whitened_residual(row), fit.whitened_residual(row + 1), fit.whitened_residual(row + 2)}});
  }
  return series;
}

std::vector<std::pair<std::string, std::vector<double>>> left_out_of(const measurement::Dataset& dataset,
                                                                     const estimation::FitResult& fit,
                                                                     const std::vector<bool>& fixed) {
  const auto folds = validation::folds_of(dataset.data);
  std::vector<std::pair<std::string, std::vector<double>>> parameters;
  for (const std::string& name : base_quantity_names()) parameters.push_back({name, {}});
  for (std::size_t fold = 0; fold < validation::kFolds; ++fold) {
    const wheels::BaseParameters base =
        vehicle::to_base(vehicle::as_span(validation::without_fold(fit, folds, fold, fixed)));
    const double values[] = {2.0 * base.left_radius, 2.0 * base.right_radius,
                             base.track_width,       base.mount.x,
                             base.mount.y,           math::wrap_angle(base.mount.yaw)};
    for (std::size_t k = 0; k < parameters.size(); ++k) parameters[k].second.push_back(values[k]);
  }
  return parameters;
}

std::array<double, 3> numbers(const math::Pose& motion) {
  return {motion.x, motion.y, math::wrap_angle(motion.yaw)};
}

}  // namespace

ReportData make_report_data(const measurement::Dataset& dataset, const selection::SearchResult& found,
                            const std::optional<estimation::FitResult>& plain) {
  const vehicle::EffectList& effects = found.model.effects;
  const estimation::FitResult& fit = found.model.fit;
  ReportData data;
  const auto fixed = vehicle::fixed_with(dataset.fixed(), effects);
  const validation::JudgedModel full{&fit, fixed, effects};
  const validation::JudgedModel geometry{plain ? &*plain : nullptr, dataset.fixed(), {}};
  const validation::JudgedModel* without_effects = plain && !effects.empty() ? &geometry : nullptr;
  data.drive_errors = validation::drive_errors(dataset.data, dataset.nominal, without_effects, full);
  data.growth = validation::error_growth(dataset.data, dataset.nominal, without_effects, full);
  data.traces = report::residual_traces(dataset.data, effects, fit, fixed, found.nuisance);
  data.detectable = found.detectable;
  data.paths = paths_of(dataset, effects, fit);
  data.scans = scan_overlay(dataset, effects, fit, fixed);
  data.axes = {axis_of(fit, 0, "x", "m"), axis_of(fit, 1, "y", "m"), axis_of(fit, 2, "yaw", "rad")};
  add_noise(dataset, fit, data.axes);
  data.series = series_of(dataset, fit);
  data.left_out = left_out_of(dataset, fit, fixed);
  return data;
}

std::vector<measurement::SamplePair> sample_pairs(const measurement::Dataset& dataset,
                                                  const vehicle::EffectList& effects,
                                                  const estimation::FitResult& fit) {
  const math::Pose mount = vehicle::to_base(vehicle::as_span(fit.parameters)).mount;
  const Eigen::VectorXd nominal = validation::with_wheels(fit.parameters, effects, dataset.nominal);
  std::vector<measurement::SamplePair> samples;
  for (std::size_t i = 0; i < dataset.data.size(); ++i) {
    const vehicle::Trajectory odometry =
        dataset.data[i].model->trajectory(vehicle::as_span(nominal), effects);
    for (const measurement::SensorPair& pair : dataset.data[i].pairs) {
      const auto& [begin, end] = pair.interval;
      samples.push_back({i, begin, end, numbers(between(odometry.at(begin), odometry.at(end))),
                         numbers(conjugate(pair.motion, inverse(mount)))});
    }
  }
  return samples;
}

}  // namespace odomcalib::calib::report
