// What all ranges of a recording are wrong by, as far as a map of walls can show it: walls that are seen
// under all angles and from all distances look bent.
#pragma once

#include <Eigen/Core>

#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::measurement {

inline constexpr Eigen::Index kRangeCoefficients = 5;

/// Coefficients: an offset, m, and those of slants(). Both bend a wall nearly alike, 1 / cos(incidence)
/// against its tangent, so that neither is determined without the other.
using RangeErrorTerms = Eigen::Matrix<double, kRangeCoefficients, 1>;

/// Derivatives of a reading by the coefficients.
RangeErrorTerms by_coefficient(const terms::Sighting& sighting);

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

}  // namespace odomcalib::calib::measurement
