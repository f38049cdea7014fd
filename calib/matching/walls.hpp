// Straight pieces of a scan. A wall averages all its readings, so that its direction is known much better
// than that of a line through a few neighbours.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calib/matching/surface.hpp"

namespace odomcalib::calib::matching {

/// Weighted moments of points; those of two sets of points add up.
struct LineSums {
  double weight = 0.0;  ///< sum of 1/variance, 1/m^2
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  /// Mean contribution of range noise to `second`. It lies along the beams, so that on a wall seen at a slant
  /// it would turn the line towards them.
  Eigen::Matrix2d noise = Eigen::Matrix2d::Zero();
  std::size_t count = 0;

  /// @param spread the beam's unit vector times the deviation of its range, m
  void add(const Eigen::Vector2d& point, double point_weight,
           const Eigen::Vector2d& spread = Eigen::Vector2d::Zero());
  LineSums& operator+=(const LineSums& other);
  [[nodiscard]] Eigen::Vector2d centre() const { return first / weight; }
};

/// The line that fits weighted points best in the sense of total least squares, with the mean effect of the
/// range noise taken out of their moments (Fuller, Measurement Error Models, 1987, section 1.3).
struct FittedLine {
  Eigen::Vector2d centre;
  Eigen::Vector2d normal;        ///< of length 1; its side is arbitrary
  double squares = 0.0;          ///< weighted sum of squared distances; chi-square with count - 2 degrees
  double angle_variance = 1e30;  ///< rad^2, of the normal's direction
  [[nodiscard]] Eigen::Vector2d direction() const { return {-normal.y(), normal.x()}; }
};
FittedLine fit_line(const LineSums& sums);

/// Where a beam meets the line, along `line.direction()` from its centre, m. The reading's own noise moves
/// its end along a slanted wall; what is chosen by where beams meet the wall is not chosen by its noise.
/// @param end anywhere on the beam
double place_of_beam(const FittedLine& line, const Eigen::Vector2d& end, const Eigen::Vector2d& beam);

/// Where a reading's beam meets the line, m from the sensor. Chosen by it instead of by its range, readings
/// are not chosen by their noise.
/// @param distance of the reading from the line along `normal`, m
double range_to_line(const SurfacePoint& point, double distance, double cosine_of_incidence);

/// Variance of a reading's distance from a line, m^2: range noise acts along the beam, unevenness of surfaces
/// and the angular error of beams in every direction.
double distance_variance(double cosine_of_incidence, double range_noise);

struct Wall {
  LineSums sums;
  FittedLine line;
  double low = 0.0, high = 0.0;  ///< m, ends along `line.direction()` from `line.centre`
};

struct Walls {
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<Wall> walls;
  std::vector<std::size_t> of_point;  ///< index into `walls`, or kNone, for each point of the surface
};

/// Splits a surface into walls: runs without gaps are cut at their farthest point until what remains is
/// straight within the noise; neighbouring pieces of one line are joined again.
Walls find_walls(const Surface& surface, double range_noise);

}  // namespace odomcalib::calib::matching
