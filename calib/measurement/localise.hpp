// Where a scan was taken, in a map of walls.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/matching/settings.hpp"
#include "calib/measurement/range_error_terms.hpp"
#include "calib/measurement/settings.hpp"
#include "calib/measurement/wall_map.hpp"

namespace odomcalib::calib::measurement {

struct PlaceOptions {
  double range_noise = matching::settings::kUsualRangeNoise_m;  ///< m
  double gate = settings::kPlaceGate_m;  ///< m, largest difference of a range from what the map expects
  int iterations = settings::kMostPlaceSteps;
  RangeErrorTerms range_error = RangeErrorTerms::Zero();  ///< taken out of every reading
  /// m, where the sensor gives up; 0: nobody knows. Of walls near it only the readings come through that
  /// noise has shortened.
  double range_max = 0.0;
};

struct Place {
  math::Pose pose;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< of x, y (map axes), yaw; the map taken as exact
  std::size_t strikes = 0;                                ///< beams that should strike a known wall
  std::size_t inliers = 0;                                ///< of those, beams that did
  double scale = 1.0;  ///< robust sigma of the ranges over their stated noise
  bool converged = false;
  /// Enough walls from enough sides.
  [[nodiscard]] bool is_usable() const;
};

Place place_scan(const WallMap& map, const std::vector<Beam>& beams, const math::Pose& guess,
                 const PlaceOptions& options);

/// What a reading says once the ranges' error is taken out. Nothing when its wall is so far away that noise
/// decides whether there is a reading.
std::optional<RangeTerm> range_term(const WallMap& map, const Beam& beam, std::size_t wall,
                                    const math::Frame& sensor, const PlaceOptions& options);

/// Readings of a scan that is in its place, as far as they fit the map.
std::vector<RangeTerm> fitting_terms(const WallMap& map, const std::vector<Beam>& beams,
                                     const math::Pose& sensor, const PlaceOptions& options);

/// What a reading counts, 1/m^2: less the farther out it lies, nothing beyond a few robust sigmas.
double weight_of(const RangeTerm& term, double scale);

}  // namespace odomcalib::calib::measurement
