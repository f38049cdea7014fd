#include "calib/comparison/parameter_trends.hpp"

#include <cmath>

namespace odomcalib::calib::comparison {
namespace {

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
