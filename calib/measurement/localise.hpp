// Where a scan was taken, in a map of walls.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "calib/matching/settings.hpp"
#include "calib/measurement/settings.hpp"
#include "calib/measurement/wall_map.hpp"
#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::measurement {

inline constexpr Eigen::Index kRangeCoefficients = 5;

/// Coefficients: an offset, m, and those of slants(). Both bend a wall nearly alike, 1 / cos(incidence)
/// against its tangent, so that neither is determined without the other.
using RangeErrorTerms = Eigen::Matrix<double, kRangeCoefficients, 1>;

/// Derivatives of a reading by the coefficients.
RangeErrorTerms by_coefficient(const terms::Sighting& sighting);

/// Common error of all ranges of a recording, as far as a map of walls can show it: walls that are seen under
/// all angles and from all distances look bent.
struct RangeEvidence {
  RangeErrorTerms values =
      RangeErrorTerms::Zero();  ///< fitted beside one another, and beside all walls and poses
  Eigen::Matrix<double, kRangeCoefficients, kRangeCoefficients> covariance =
      Eigen::Matrix<double, kRangeCoefficients,
                    kRangeCoefficients>::Identity();  ///< of the ranges' noise alone
  double offset_alone = 0.0;                          ///< m, fitted without a dependence on incidence
  double offset_alone_deviation = 0.0;
};

/// An offset that a dependence on incidence neither explains nor changes much.
bool shows_offset(const RangeEvidence& evidence);

/// A dependence on incidence beside which an offset is not needed.
bool shows_slant(const RangeEvidence& evidence);

/// Whether a fitted error errs at a slant by more than surfaces of a room differ.
bool matters_at_a_slant(const RangeErrorTerms& dependence);

/// Probability of so large an offset, or so large coefficients of the incidence, where there is none.
double p_value_of_offset(const RangeEvidence& evidence);
double p_value_of_slant(const RangeEvidence& evidence);

struct PlaceOptions {
  double range_noise = matching::settings::kUsualRangeNoise_m;  ///< m
  double gate = settings::kFirstGate_m;  ///< m, largest difference of a range from what the map expects
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

/// Term of a reading once the ranges' error is taken out. Nothing when its wall is so far away that noise
/// decides whether there is a reading.
std::optional<RangeTerm> range_term(const WallMap& map, const Beam& beam, std::size_t wall,
                                    const math::Frame& sensor, const PlaceOptions& options);

/// Readings of a scan that is in its place, as far as they fit the map.
std::vector<RangeTerm> fitting_terms(const WallMap& map, const std::vector<Beam>& beams,
                                     const math::Pose& sensor, const PlaceOptions& options);

/// Weight of a reading, 1/m^2: less the farther out it lies, nothing beyond a few robust sigmas.
double weight_of(const RangeTerm& term, double scale);

}  // namespace odomcalib::calib::measurement
