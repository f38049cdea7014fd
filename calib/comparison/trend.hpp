// A line through what several calibrations say of one quantity, and when it passes a bound.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/comparison/state.hpp"

namespace odomcalib::calib::comparison {

struct TrendPoint {
  double x = 0.0;  ///< days, m or a number of calibrations
  double value = 0.0, std = 0.0;
};

/// value = level + slope (x - centre). About the weighted centre the errors of level and slope are
/// uncorrelated.
struct Line {
  double centre = 0.0, level = 0.0, slope = 0.0;
  double level_std = 0.0, slope_std = 0.0;  ///< with the scatter
  double scatter = 1.0;     ///< of the values about the line over their own deviations, where that is more
                            ///< than one (R. T. Birge, Phys. Rev. 40, 1932)
  double scatter_p = 1.0;   ///< that so much scatter is chance
  double p_value = 1.0;     ///< that so large a slope is chance
  double half_width = 0.0;  ///< of an interval of kIntervalLevel, in deviations
  double last = 0.0;        ///< largest x
  std::size_t points = 0;

  [[nodiscard]] double at(double x) const { return level + slope * (x - centre); }
  [[nodiscard]] double std_at(double x) const;
  [[nodiscard]] bool is_significant() const;
  /// More than the deviations of the values explain.
  [[nodiscard]] bool scatters() const;
};

/// Weighted by the deviations. Where the values scatter more about it than these say, its deviations grow
/// with the scatter, and Student's t with two degrees of freedom less than there are points takes the place
/// of the normal distribution. nullopt for fewer than two different x or a deviation that is not positive.
std::optional<Line> weighted_line(std::span<const TrendPoint> points);

/// Where the line passes a bound, with its interval (E. C. Fieller, J. R. Statist. Soc. B 16, 1954).
struct Crossing {
  std::optional<double> at;  ///< where the line passes it, at or after the last point; none: it does not
  std::optional<double> earliest;  ///< from where on it may have passed; none: never, with this line
  std::optional<double> latest;    ///< where it has certainly passed; none: nobody can say
};

/// The first bound that is passed after the last point.
Crossing crossing(const Line& line, double lower, double upper);

/// Values of several calibrations over date, distance or number, with their line.
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
