#include "calib/report/residual_trace.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "calib/estimation/stack.hpp"
#include "calib/report/settings.hpp"
#include "calib/validation/settings.hpp"

namespace odomcalib::calib::report {
namespace {

/// A covariate that a defect may depend on: its mean or sum over a measured motion, or its value at the
/// middle. Simple ones first: they are preferred.
struct Covariate {
  const char* name;
  const char* unit;
  enum Over { mean, middle, sum } over;
  double (*of)(const vehicle::StepContext&);
};

/// 1 when the wheel just turned to forward, -1 to backward, otherwise 0.
double left_reversal(const vehicle::StepContext& c) {
  return c.lost_to_play().left[settings::kUsualPlay] / vehicle::kPlays[settings::kUsualPlay];
}
double right_reversal(const vehicle::StepContext& c) {
  return c.lost_to_play().right[settings::kUsualPlay] / vehicle::kPlays[settings::kUsualPlay];
}

constexpr std::array kCovariates = {
    Covariate{"speed", "m/s", Covariate::mean, [](const vehicle::StepContext& c) { return c.speed; }},
    Covariate{"turn rate", "rad/s", Covariate::mean,
              [](const vehicle::StepContext& c) { return c.turn_rate; }},
    Covariate{"left wheel speed", "m/s", Covariate::mean,
              [](const vehicle::StepContext& c) { return c.left_speed; }},
    Covariate{"right wheel speed", "m/s", Covariate::mean,
              [](const vehicle::StepContext& c) { return c.right_speed; }},
    Covariate{"lateral acceleration", "m/s^2", Covariate::mean,
              [](const vehicle::StepContext& c) { return c.speed * c.turn_rate; }},
    Covariate{
        "acceleration", "m/s^2", Covariate::mean,
        [](const vehicle::StepContext& c) { return 0.5 * (c.left_acceleration + c.right_acceleration); }},
    Covariate{"left wheel acceleration", "m/s^2", Covariate::mean,
              [](const vehicle::StepContext& c) { return c.left_acceleration; }},
    Covariate{"right wheel acceleration", "m/s^2", Covariate::mean,
              [](const vehicle::StepContext& c) { return c.right_acceleration; }},
    Covariate{"difference of wheel accelerations", "m/s^2", Covariate::mean,
              [](const vehicle::StepContext& c) { return c.right_acceleration - c.left_acceleration; }},
    Covariate{"left wheel angle", "rad", Covariate::middle,
              [](const vehicle::StepContext& c) { return c.left_angle; }},
    Covariate{"right wheel angle", "rad", Covariate::middle,
              [](const vehicle::StepContext& c) { return c.right_angle; }},
    Covariate{"reversals of the left wheel", "", Covariate::sum, left_reversal},
    Covariate{"reversals of the right wheel", "", Covariate::sum, right_reversal},
    Covariate{"reversals of both wheels", "", Covariate::sum,
              [](const vehicle::StepContext& c) { return left_reversal(c) + right_reversal(c); }},
    Covariate{"reversals, right less left wheel", "", Covariate::sum,
              [](const vehicle::StepContext& c) { return right_reversal(c) - left_reversal(c); }},
    Covariate{"distance since reversal", "m", Covariate::mean,
              [](const vehicle::StepContext& c) { return c.direction * std::min(c.since_reversal, 0.5); }},
    Covariate{
        "distance since a stop", "m", Covariate::mean,
        [](const vehicle::StepContext& c) { return std::min(c.since_stop[vehicle::kUsualMemory], 0.5); }},
    Covariate{"stop after a straight motion", "", Covariate::sum,
              [](const vehicle::StepContext& c) { return c.unwound[0].way; }},
    Covariate{"stop after a turn", "", Covariate::sum,
              [](const vehicle::StepContext& c) { return c.unwound[0].turn; }},
    Covariate{"left wheel acceleration, braking negative", "m/s^2", Covariate::mean,
              [](const vehicle::StepContext& c) {
                return vehicle::growth_of_speed_magnitude(c.left_acceleration, c.left_speed);
              }},
    Covariate{"right wheel acceleration, braking negative", "m/s^2", Covariate::mean,
              [](const vehicle::StepContext& c) {
                return vehicle::growth_of_speed_magnitude(c.right_acceleration, c.right_speed);
              }},
    Covariate{"acceleration, braking negative", "m/s^2", Covariate::mean,
              [](const vehicle::StepContext& c) {
                return vehicle::growth_of_speed_magnitude(0.5 * (c.left_acceleration + c.right_acceleration),
                                                          c.speed);
              }},
    Covariate{"last turn", "", Covariate::mean,
              [](const vehicle::StepContext& c) { return c.previous_turn[vehicle::kUsualMemory]; }},
    Covariate{"last push", "", Covariate::mean,
              [](const vehicle::StepContext& c) { return c.previous_acceleration[vehicle::kUsualMemory]; }},
    Covariate{"place, x", "m", Covariate::mean, [](const vehicle::StepContext& c) { return c.x; }},
    Covariate{"place, y", "m", Covariate::mean, [](const vehicle::StepContext& c) { return c.y; }},
    Covariate{
        "left wheel since reversal", "rad", Covariate::mean,
        [](const vehicle::StepContext& c) { return std::min(c.left_since_reversal, settings::kFarBack); }},
    Covariate{
        "right wheel since reversal", "rad", Covariate::mean,
        [](const vehicle::StepContext& c) { return std::min(c.right_since_reversal, settings::kFarBack); }},
    Covariate{"time", "s", Covariate::mean, [](const vehicle::StepContext& c) { return c.t; }},
    Covariate{"heading", "rad", Covariate::middle, [](const vehicle::StepContext& c) { return c.heading; }},
};

/// Divisor of a residual: nothing, the distance driven, or the angle turned.
struct Divisor {
  const char* length_unit;
  const char* angle_unit;
  double least;  ///< smaller ones are left out of the picture
  double (*of)(const math::Pose& motion);
};
constexpr std::array kDivisors = {
    Divisor{"m", "rad", 0.0, [](const math::Pose&) { return 1.0; }},
    Divisor{"m/m", "rad/m", settings::kLeastDividingWay_m, [](const math::Pose& m) { return m.x; }},
    Divisor{"m/rad", "rad/rad", settings::kLeastDividingTurn_rad, [](const math::Pose& m) { return m.yaw; }},
};

constexpr std::array kAxes = {"forward", "sideways", "heading"};

/// All pairs that count, with everything that a trace may be drawn from.
struct Samples {
  std::vector<math::Pose> motion;                     ///< measured, of the base
  std::vector<std::array<double, 3>> after, pattern;  ///< residual of the full model; what the effect adds
  std::vector<std::array<double, kCovariates.size()>> covariates;
};

std::array<double, kCovariates.size()> covariates_of(const vehicle::DriveModel& model,
                                                     const vehicle::Interval& interval) {
  const auto context = model.context_within(interval);
  std::array<double, kCovariates.size()> values{};
  for (std::size_t v = 0; v < kCovariates.size(); ++v) {
    if (kCovariates.at(v).over == Covariate::middle) {
      values.at(v) = math::angle_of_turn(kCovariates.at(v).of(context[(context.size() - 1) / 2]));
      continue;
    }
    for (const vehicle::StepContext& c : context) values.at(v) += kCovariates.at(v).of(c);
    if (kCovariates.at(v).over == Covariate::mean) values.at(v) /= static_cast<double>(context.size());
  }
  return values;
}

std::array<double, 3> components_between(const math::Pose& a, const math::Pose& b) {
  return {a.x - b.x, a.y - b.y, math::wrap_angle(a.yaw - b.yaw)};
}

Samples samples_of(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
                   const estimation::FitResult& fit, const Eigen::VectorXd& without) {
  Samples samples;
  const math::Pose back = inverse(vehicle::to_base(vehicle::as_span(fit.parameters)).mount);
  std::size_t row = 0;
  for (const measurement::FitData& d : data) {
    const std::vector<vehicle::Interval> intervals = estimation::intervals_of(d.pairs);
    const auto full = d.model->predict(vehicle::as_span(fit.parameters), effects, intervals);
    const auto plain = d.model->predict(vehicle::as_span(without), effects, intervals);
    for (std::size_t k = 0; k < d.pairs.size(); ++k, ++row) {
      if (fit.weights[row] < validation::settings::kTrustedWeight) continue;
      const math::Pose measured = conjugate(d.pairs[k].motion, back);
      const math::Pose with_effect = conjugate(full[k], back);
      samples.motion.push_back(measured);
      samples.after.push_back(components_between(measured, with_effect));
      samples.pattern.push_back(components_between(with_effect, conjugate(plain[k], back)));
      samples.covariates.push_back(covariates_of(*d.model, intervals[k]));
    }
  }
  return samples;
}

double mean_square(const std::vector<std::array<double, 3>>& rows, std::size_t axis) {
  double sum = 0.0;
  for (const auto& row : rows) sum += row.at(axis) * row.at(axis);
  return sum / std::max(static_cast<double>(rows.size()), 1.0);
}

/// One way to draw the trace: indices of the samples in the order of the covariate.
struct View {
  std::size_t variable = 0, divisor = 0, axis = 0;
  std::vector<std::size_t> order;
  double explained = 0.0;
};

std::size_t bin_begin(std::size_t bin, std::size_t count) { return bin * count / settings::kTraceBins; }

/// Share of the pattern's variation that a function of the covariate describes (correlation ratio).
double correlation_ratio(const Samples& samples, const View& view) {
  const Divisor& divisor = kDivisors.at(view.divisor);
  const auto value = [&](std::size_t i) {
    return samples.pattern[i].at(view.axis) / divisor.of(samples.motion[i]);
  };
  double mean = 0.0;
  for (const std::size_t i : view.order) mean += value(i);
  mean /= static_cast<double>(view.order.size());
  double total = 0.0;
  double within = 0.0;
  for (std::size_t bin = 0; bin < settings::kTraceBins; ++bin) {
    const std::size_t first = bin_begin(bin, view.order.size());
    const std::size_t last = bin_begin(bin + 1, view.order.size());
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t k = first; k < last; ++k) {
      const double v = value(view.order[k]);
      sum += v;
      squares += v * v;
      total += (v - mean) * (v - mean);
    }
    within += squares - sum * sum / std::max(static_cast<double>(last - first), 1.0);
  }
  return total > 0.0 ? 1.0 - within / total : 0.0;
}

View make_view(const Samples& samples, std::size_t variable, std::size_t divisor, std::size_t axis) {
  View view{variable, divisor, axis, {}, 0.0};
  for (std::size_t i = 0; i < samples.motion.size(); ++i)
    if (std::abs(kDivisors.at(divisor).of(samples.motion[i])) >= kDivisors.at(divisor).least)
      view.order.push_back(i);
  std::stable_sort(view.order.begin(), view.order.end(), [&](std::size_t a, std::size_t b) {
    return samples.covariates[a].at(variable) < samples.covariates[b].at(variable);
  });
  if (view.order.size() >= 2 * settings::kTraceBins) view.explained = correlation_ratio(samples, view);
  return view;
}

/// The axis in which the pattern stands out most from the noise.
std::size_t loudest_axis(const Samples& samples) {
  std::size_t best = 0;
  double loudest = -1.0;
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    const double noise = mean_square(samples.after, axis);
    const double ratio = noise > 0.0 ? mean_square(samples.pattern, axis) / noise : 0.0;
    if (ratio > loudest) best = axis;
    loudest = std::max(loudest, ratio);
  }
  return best;
}

View best_view(const Samples& samples) {
  const std::size_t axis = loudest_axis(samples);
  View best = make_view(samples, 0, 0, axis);
  for (std::size_t divisor = 0; divisor < kDivisors.size(); ++divisor)
    for (std::size_t variable = 0; variable < kCovariates.size(); ++variable) {
      View view = make_view(samples, variable, divisor, axis);
      const double lead = divisor == best.divisor ? settings::kWorthChanging : settings::kWorthDividing;
      if (view.explained > best.explained + lead) best = std::move(view);
    }
  return best;
}

ResidualTrace::Bin bin_of(const std::vector<ResidualTrace::Point>& points) {
  ResidualTrace::Bin bin;
  const double n = static_cast<double>(points.size());
  for (const auto& p : points) {
    bin.variable += p.variable / n;
    bin.before += p.before / n;
    bin.after += p.after / n;
  }
  double before = 0.0;
  double after = 0.0;
  for (const auto& p : points) {
    before += std::pow(p.before - bin.before, 2);
    after += std::pow(p.after - bin.after, 2);
  }
  const double scale = n > 1.0 ? 1.96 / std::sqrt(n * (n - 1.0)) : 0.0;
  bin.before_error = scale * std::sqrt(before);
  bin.after_error = scale * std::sqrt(after);
  return bin;
}

/// Ranges of points, first and one past last: one a value where there are few values, otherwise equally
/// filled ones.
std::vector<std::pair<std::size_t, std::size_t>> bins_of(const std::vector<ResidualTrace::Point>& points) {
  std::vector<std::pair<std::size_t, std::size_t>> bins;
  for (std::size_t k = 0; k < points.size() && bins.size() <= settings::kTraceBins; ++k) {
    const bool same = k > 0 && points[k].variable == points[k - 1].variable;
    if (!same) bins.emplace_back(k, k);
    bins.back().second = k + 1;
  }
  if (bins.size() <= settings::kTraceBins) return bins;
  bins.clear();
  for (std::size_t bin = 0; bin < settings::kTraceBins && points.size() >= 2 * settings::kTraceBins; ++bin)
    bins.emplace_back(bin_begin(bin, points.size()), bin_begin(bin + 1, points.size()));
  return bins;
}

ResidualTrace drawn(const Samples& samples, const View& view) {
  const Divisor& divisor = kDivisors.at(view.divisor);
  ResidualTrace trace;
  trace.variable = kCovariates.at(view.variable).name;
  trace.variable_unit = kCovariates.at(view.variable).unit;
  trace.residual = kAxes.at(view.axis);
  trace.residual_unit = view.axis == 2 ? divisor.angle_unit : divisor.length_unit;
  trace.explained = view.explained;
  std::vector<ResidualTrace::Point> points;
  for (const std::size_t i : view.order) {
    const double scale = divisor.of(samples.motion[i]);
    const double after = samples.after[i].at(view.axis);
    points.push_back({samples.covariates[i].at(view.variable),
                      (after + samples.pattern[i].at(view.axis)) / scale, after / scale});
  }
  for (const auto& [first, last] : bins_of(points))
    trace.bins.push_back(bin_of({points.begin() + static_cast<std::ptrdiff_t>(first),
                                 points.begin() + static_cast<std::ptrdiff_t>(last)}));
  const std::size_t step =
      std::max<std::size_t>(1, (points.size() + settings::kMostTracePoints - 1) / settings::kMostTracePoints);
  for (std::size_t k = step / 2; k < points.size(); k += step) trace.points.push_back(points[k]);
  return trace;
}

/// Parameters refitted with the effect's own kept where they do nothing; nullopt when that does not work.
std::optional<Eigen::VectorXd> fitted_without(std::span<const measurement::FitData> data,
                                              const vehicle::EffectList& effects,
                                              const estimation::FitResult& fit, std::vector<bool> fixed,
                                              std::size_t first, const vehicle::Effect& without) {
  Eigen::VectorXd start = fit.parameters;
  for (const vehicle::EffectParameter& parameter : without.parameters()) {
    start(static_cast<Eigen::Index>(first)) = parameter.start;
    fixed[first++] = true;
  }
  const auto refitted = estimation::fit_joint(data, effects, start, {fixed, 20, fit.noise});
  if (!refitted) return std::nullopt;
  return refitted.value().parameters;
}

}  // namespace

std::vector<ResidualTrace> residual_traces(std::span<const measurement::FitData> data,
                                           const vehicle::EffectList& effects,
                                           const estimation::FitResult& fit, const std::vector<bool>& fixed,
                                           const vehicle::EffectList& nuisance) {
  std::vector<ResidualTrace> traces;
  std::size_t next = vehicle::kBaseCount;
  for (const auto& effect : effects) {
    const std::size_t first = next;
    next += effect->parameters().size();
    if (std::find(nuisance.begin(), nuisance.end(), effect) != nuisance.end()) continue;
    const auto without = fitted_without(data, effects, fit, fixed, first, *effect);
    if (!without) continue;
    const Samples samples = samples_of(data, effects, fit, *without);
    const View view = best_view(samples);
    if (view.order.empty()) continue;
    traces.push_back(drawn(samples, view));
    traces.back().effect = effect->name();
  }
  return traces;
}

}  // namespace odomcalib::calib::report
