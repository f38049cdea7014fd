#include "calib/report/report.hpp"

#include <algorithm>
#include <cmath>

#include "calib/classical/closed_form.hpp"
#include "calib/classical/linear.hpp"
#include "calib/classical/manual.hpp"
#include "proto/base_quantities.hpp"
#include "proto/calibration/utc.hpp"

namespace odomcalib::calib::report {
namespace {

constexpr double kRadiusToDiameter = 2.0;

double deviation(const Eigen::MatrixXd& covariance, Eigen::Index k) {
  if (k >= covariance.rows() || !(covariance(k, k) > 0.0)) return -1.0;
  return std::sqrt(covariance(k, k)) * (k < 2 ? kRadiusToDiameter : 1.0);
}

/// An entry of a list, in the unit of the quantity.
std::pair<std::string, Quantity> of(BaseQuantity quantity, double value, double std) {
  return {name_of(quantity), {value, std, row_of(quantity).unit}};
}

MethodResult refused_method(const std::string& name, const Error& error) {
  MethodResult result;
  result.name = name;
  result.refused = error.remedy.empty() ? error.what : error.what + "; " + error.remedy;
  return result;
}

MethodResult straight_method(std::span<const wheels::WheelMotion> samples,
                             const wheels::BaseParameters& nominal) {
  const auto ratio = classical::straight_ratio(samples, nominal);
  if (!ratio) return refused_method("straight", ratio.error());
  const classical::Ratio& r = ratio.value();
  MethodResult result;
  result.name = "straight";
  result.parameters = {of(BaseQuantity::left_wheel_diameter, 2.0 * nominal.left_radius * r.value,
                          2.0 * nominal.left_radius * r.std),
                       of(BaseQuantity::right_wheel_diameter, 2.0 * nominal.right_radius * r.value,
                          2.0 * nominal.right_radius * r.std)};
  result.rms = {r.rms, 0.0, 0.0};
  result.used = r.used;
  result.discarded = r.discarded;
  return result;
}

MethodResult spin_method(std::span<const wheels::WheelMotion> samples,
                         const wheels::BaseParameters& nominal) {
  wheels::BaseParameters corrected = nominal;
  if (const auto straight = classical::straight_ratio(samples, nominal); straight) {
    corrected.left_radius *= straight.value().value;
    corrected.right_radius *= straight.value().value;
  }
  const auto ratio = classical::spin_ratio(samples, corrected);
  if (!ratio) return refused_method("spin", ratio.error());
  const classical::Ratio& r = ratio.value();
  MethodResult result;
  result.name = "spin";
  result.parameters = {
      of(BaseQuantity::track_width, nominal.track_width * r.value, nominal.track_width * r.std)};
  result.rms = {0.0, 0.0, r.rms};
  result.used = r.used;
  result.discarded = r.discarded;
  return result;
}

/// Increments of the base by odometry and by the sensor, the latter moved from the sensor to the base.
std::vector<classical::IncrementPair> base_increments(std::span<const wheels::WheelMotion> samples,
                                                      const wheels::BaseParameters& nominal,
                                                      const std::vector<std::size_t>* subset) {
  std::vector<classical::IncrementPair> increments;
  const auto add = [&](const wheels::WheelMotion& sample) {
    increments.push_back({wheels::wheel_arc(nominal.left_radius * sample.left,
                                            nominal.right_radius * sample.right, nominal.track_width),
                          conjugate(sample.sensor_motion, inverse(nominal.mount))});
  };
  if (subset != nullptr)
    for (const std::size_t i : *subset) add(samples[i]);
  else
    for (const wheels::WheelMotion& sample : samples) add(sample);
  return increments;
}

MethodResult linear_method(std::span<const wheels::WheelMotion> samples,
                           const wheels::BaseParameters& nominal, const std::vector<std::size_t>* inliers,
                           Calibration& calibration) {
  const auto solved = solve_linear(base_increments(samples, nominal, inliers));
  if (!solved) return refused_method("linear", solved.error());
  const classical::LinearResult& linear = solved.value();
  LinearCorrection correction;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      correction.matrix[i][j] = linear.matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  correction.condition = linear.condition;
  correction.rms = {linear.rms(0), linear.rms(1), linear.rms(2)};
  calibration.linear_correction = correction;
  const classical::LinearReading reading = classical::read_linear(
      linear.matrix, (nominal.left_radius + nominal.right_radius) / 2.0, nominal.track_width);
  MethodResult result;
  result.name = "linear";
  result.parameters = {of(BaseQuantity::left_wheel_diameter, 2.0 * reading.left_radius, -1.0),
                       of(BaseQuantity::right_wheel_diameter, 2.0 * reading.right_radius, -1.0),
                       of(BaseQuantity::track_width, reading.track_width, -1.0)};
  result.rms = correction.rms;
  result.used = linear.used;
  result.discarded = samples.size() - linear.used;
  return result;
}

}  // namespace

std::vector<std::string> base_quantity_names() {
  std::vector<std::string> names;
  names.reserve(kBaseQuantities.size());
  for (const BaseQuantityRow& row : kBaseQuantities) names.emplace_back(row.name);
  return names;
}

QuantityList base_quantities(const wheels::BaseParameters& base, const Eigen::MatrixXd& covariance) {
  const double values[] = {2.0 * base.left_radius, 2.0 * base.right_radius,
                           base.track_width,       base.mount.x,
                           base.mount.y,           math::wrap_angle(base.mount.yaw)};
  QuantityList list;
  for (std::size_t k = 0; k < kBaseQuantities.size(); ++k)
    list.push_back(of(kBaseQuantities[k].id, values[k], deviation(covariance, static_cast<Eigen::Index>(k))));
  return list;
}

Eigen::MatrixXd with_scale_error(const Eigen::MatrixXd& covariance, const wheels::BaseParameters& base,
                                 double deviation) {
  Eigen::VectorXd lengths = Eigen::VectorXd::Zero(covariance.rows());
  lengths.head<5>() << base.left_radius, base.right_radius, base.track_width, base.mount.x, base.mount.y;
  for (Eigen::Index k = 0; k < lengths.size(); ++k)
    if (!(covariance(k, k) > 0.0)) lengths(k) = 0.0;
  return covariance + deviation * deviation * lengths * lengths.transpose();
}

std::vector<std::vector<double>> diameter_covariance(const Eigen::MatrixXd& covariance) {
  std::vector<std::vector<double>> rows(vehicle::kBaseCount, std::vector<double>(vehicle::kBaseCount, 0.0));
  for (std::size_t i = 0; i < vehicle::kBaseCount; ++i)
    for (std::size_t j = 0; j < vehicle::kBaseCount; ++j)
      rows[i][j] = covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) *
                   (i < 2 ? kRadiusToDiameter : 1.0) * (j < 2 ? kRadiusToDiameter : 1.0);
  return rows;
}

std::vector<MethodResult> classical_methods(const measurement::Dataset& dataset, double delay,
                                            const classical::ClosedFormOptions& cuts,
                                            Calibration& calibration) {
  const auto samples = whole_wheel_motions(dataset.data, delay);
  std::vector<MethodResult> methods;
  methods.push_back(straight_method(samples, dataset.nominal));
  methods.push_back(spin_method(samples, dataset.nominal));
  const auto closed = classical::solve_closed_form(samples, cuts);
  methods.push_back(
      linear_method(samples, dataset.nominal, closed ? &closed.value().inliers : nullptr, calibration));
  if (!closed) {
    methods.push_back(refused_method("joint_closed_form", closed.error()));
    return methods;
  }
  MethodResult joint;
  joint.name = "joint_closed_form";
  joint.parameters = base_quantities(closed.value().parameters, closed.value().covariance);
  joint.rms = {closed.value().rms(0), closed.value().rms(1), closed.value().rms(2)};
  joint.used = closed.value().inliers.size();
  joint.discarded = samples.size() - joint.used;
  methods.push_back(joint);
  return methods;
}

MethodResult joint_method(const estimation::FitResult& fit) {
  MethodResult result;
  result.name = "joint";
  const std::span<const double> p = vehicle::as_span(fit.parameters);
  result.parameters = base_quantities(vehicle::to_base(p), fit.covariance);
  result.rms = {fit.rms(0), fit.rms(1), fit.rms(2)};
  result.used = fit.used;
  result.discarded = fit.discarded;
  return result;
}

std::vector<DataUse> data_use(std::span<const Recording> recordings,
                              std::span<const measurement::PairSet> pairs) {
  std::vector<DataUse> uses;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const Recording& recording = recordings[i];
    DataUse use;
    use.name = recording.name;
    use.sha256 = recording.sha256;
    if (!recording.ticks.empty()) {
      use.begin = recording.ticks.front().t;
      use.duration = recording.ticks.back().t - recording.ticks.front().t;
    }
    for (const IncrementSample& sample : recording.increments) use.duration += sample.duration;
    use.counts = {{"ticks", recording.ticks.size()},
                  {"scans", recording.scans.size()},
                  {"poses", recording.poses.size()},
                  {"increments", recording.increments.size()}};
    for (const Discarded& d : recording.discarded)
      use.discarded.emplace_back(d.what + ": " + d.reason, d.count);
    use.choices = recording.choices;
    use.middleware = recording.middleware;
    if (i < pairs.size()) {
      use.counts.emplace_back("pairs", pairs[i].pairs.size());
      for (const auto& [reason, count] : pairs[i].rejected)
        use.discarded.emplace_back("pair: " + reason, count);
    }
    uses.push_back(std::move(use));
  }
  return uses;
}

std::optional<Driven> driven_in(std::span<const Recording> recordings) {
  std::optional<Driven> driven;
  const auto take = [&driven](double t) {
    if (!is_date(t)) return;
    if (!driven) driven = Driven{t, t};
    driven->begin = std::min(driven->begin, t);
    driven->end = std::max(driven->end, t);
  };
  for (const Recording& recording : recordings) {
    const auto take_ends = [&](const auto& samples) {
      if (samples.empty()) return;
      take(recording.time_zero + samples.front().t);
      take(recording.time_zero + samples.back().t);
    };
    take_ends(recording.ticks);
    take_ends(recording.scans);
    take_ends(recording.poses);
  }
  return driven;
}

}  // namespace odomcalib::calib::report
