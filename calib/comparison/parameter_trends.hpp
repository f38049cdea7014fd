// Values of several calibrations over date, distance or number, each with its line.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/comparison/state.hpp"
#include "calib/comparison/trend.hpp"

namespace odomcalib::calib::comparison {

struct ParameterTrend {
  std::string name, unit;  ///< as in the calibration file, or kMeanDiameter; SI units
  std::vector<TrendPoint> points;
  std::optional<Line> line;  ///< none where all x are alike
};

/// Trends of the parameters that all calibrations have estimated; the mean diameter first.
/// @param x of each calibration
std::vector<ParameterTrend> parameter_trends(std::span<const Calibration* const> calibrations,
                                             std::span<const double> x);

/// When a metre by the values of the newest calibration is off by more than the bound, as the mean diameter
/// goes on; nullopt without a line of it.
/// @param bound m in a metre
std::optional<Crossing> passing(const std::vector<ParameterTrend>& trends, double bound);

}  // namespace odomcalib::calib::comparison
