#include "calib/comparison/trend.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <vector>

#include "calib/comparison/settings.hpp"

namespace odomcalib::calib::comparison {
namespace {

/// Two-sided p-value of a number of deviations, and the half width of an interval.
template <typename Distribution>
void judge_slope(const Distribution& distribution, Line& line) {
  namespace bm = boost::math;
  const double deviations = std::abs(line.slope) / line.slope_std;
  line.p_value = 2.0 * bm::cdf(bm::complement(distribution, deviations));
  line.half_width = bm::quantile(bm::complement(distribution, 0.5 * (1.0 - settings::kIntervalLevel)));
}

/// Roots of a u^2 + 2 b u + c, in ascending order.
std::vector<double> roots(double a, double b, double c) {
  if (a == 0.0) return b == 0.0 ? std::vector<double>() : std::vector<double>{-0.5 * c / b};
  const double square = b * b - a * c;
  if (square < 0.0) return {};
  // Without cancellation (Press et al., Numerical Recipes, 5.6).
  const double q = -(b + std::copysign(std::sqrt(square), b));
  std::vector<double> both{q / a, q == 0.0 ? 0.0 : c / q};
  std::sort(both.begin(), both.end());
  return both;
}

/// x from the last point on at which the band of the line begins or ends to hold the bound.
std::vector<double> edges_of_band(const Line& line, double bound) {
  const double reach = line.half_width * line.half_width;
  const double apart = line.level - bound;
  std::vector<double> edges;
  for (const double u : roots(line.slope * line.slope - reach * line.slope_std * line.slope_std,
                              line.slope * apart, apart * apart - reach * line.level_std * line.level_std))
    if (line.centre + u > line.last) edges.push_back(line.centre + u);
  return edges;
}

bool may_hold(const Line& line, double x, double bound) {
  return std::abs(line.at(x) - bound) <= line.half_width * line.std_at(x);
}

void take_first(std::optional<double>& first, double x) { first = std::min(first.value_or(x), x); }

std::vector<State> states_of(std::span<const Calibration* const> calibrations) {
  std::vector<State> states;
  for (const Calibration* one : calibrations) states.push_back(state_of(*one));
  return comparable(std::move(states));
}

ParameterTrend mean_trend(const std::vector<State>& states, std::span<const double> x) {
  ParameterTrend trend{kMeanDiameter, "m", {}, std::nullopt};
  for (std::size_t k = 0; k < states.size(); ++k)
    if (const auto mean = mean_diameter(states[k])) trend.points.push_back({x[k], mean->value, mean->std});
  return trend;
}

}  // namespace

double Line::std_at(double x) const { return std::hypot(level_std, slope_std * (x - centre)); }

bool Line::scatters() const { return scatter_p < settings::kChangedLevel; }

bool Line::is_significant() const { return p_value < settings::kChangedLevel; }

std::optional<Line> weighted_line(std::span<const TrendPoint> points) {
  double weights = 0.0, x = 0.0, y = 0.0;
  for (const TrendPoint& point : points) {
    if (!(point.std > 0.0) || !std::isfinite(point.value + point.std + point.x)) return std::nullopt;
    const double w = 1.0 / (point.std * point.std);
    weights += w;
    x += w * point.x;
    y += w * point.value;
  }
  if (points.size() < 2) return std::nullopt;
  Line line{.centre = x / weights, .level = y / weights, .last = points.front().x, .points = points.size()};
  double xx = 0.0, xy = 0.0, chi_squared = 0.0;
  for (const TrendPoint& point : points) {
    const double w = 1.0 / (point.std * point.std), u = point.x - line.centre;
    xx += w * u * u;
    xy += w * u * (point.value - line.level);
    line.last = std::max(line.last, point.x);
  }
  if (!(xx > 0.0)) return std::nullopt;
  line.slope = xy / xx;
  for (const TrendPoint& point : points) {
    const double off = (point.value - line.at(point.x)) / point.std;
    chi_squared += off * off;
  }
  const auto freedom = static_cast<double>(points.size()) - 2.0;
  if (freedom > 0.0) {
    namespace bm = boost::math;
    line.scatter = std::max(1.0, std::sqrt(chi_squared / freedom));
    line.scatter_p = bm::cdf(bm::complement(bm::chi_squared(freedom), chi_squared));
  }
  line.level_std = line.scatter / std::sqrt(weights);
  line.slope_std = line.scatter / std::sqrt(xx);
  if (line.scatter > 1.0)
    judge_slope(boost::math::students_t(freedom), line);
  else
    judge_slope(boost::math::normal(), line);
  return line;
}

Crossing crossing(const Line& line, double lower, double upper) {
  Crossing found;
  const double towards = line.slope < 0.0 ? lower : upper;
  if (line.slope != 0.0) found.at = std::max(line.last, line.centre + (towards - line.level) / line.slope);
  for (const double bound : {lower, upper}) {
    if (may_hold(line, line.last, bound)) take_first(found.earliest, line.last);
    for (const double x : edges_of_band(line, bound)) take_first(found.earliest, x);
  }
  // With a slope that may be none the band never leaves the bound.
  const bool certain = std::abs(line.slope) > line.half_width * line.slope_std;
  const std::vector<double> edges = edges_of_band(line, towards);
  if (certain) found.latest = edges.empty() ? line.last : edges.back();
  if (certain && !found.earliest) found.earliest = line.last;
  if (!certain) found.at = std::nullopt;
  return found;
}

std::vector<ParameterTrend> parameter_trends(std::span<const Calibration* const> calibrations,
                                             std::span<const double> x) {
  std::vector<ParameterTrend> trends;
  const std::vector<State> states = states_of(calibrations);
  if (states.empty()) return trends;
  if (ParameterTrend mean = mean_trend(states, x); !mean.points.empty()) trends.push_back(std::move(mean));
  for (std::size_t i = 0; i < states.front().names.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    ParameterTrend trend{states.front().names[i], states.front().units[i], {}, std::nullopt};
    for (std::size_t k = 0; k < states.size(); ++k)
      trend.points.push_back({x[k], states[k].value(at), std::sqrt(states[k].covariance(at, at))});
    trends.push_back(std::move(trend));
  }
  for (ParameterTrend& trend : trends) trend.line = weighted_line(trend.points);
  return trends;
}

std::optional<Crossing> passing(const std::vector<ParameterTrend>& trends, double bound) {
  if (trends.empty() || trends.front().name != kMeanDiameter || !trends.front().line) return std::nullopt;
  const double in_force = trends.front().points.back().value;
  return crossing(*trends.front().line, in_force / (1.0 + bound), in_force / (1.0 - bound));
}

}  // namespace odomcalib::calib::comparison
