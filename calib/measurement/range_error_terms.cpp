#include "calib/measurement/range_error_terms.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

#include "calib/measurement/settings.hpp"
#include "calib/terms/lidar_smooth_term.hpp"

namespace odomcalib::calib::measurement {
namespace {

// Deviations are those of the ranges' noise alone; walls that are not quite straight add to them.
constexpr Eigen::Index kSlants = kRangeCoefficients - 1;

double offset_in_sigmas(const RangeEvidence& e) {
  return std::abs(e.values(0)) / std::sqrt(e.covariance(0, 0));
}

/// Wald's statistic of all coefficients of the incidence.
double slant_statistic(const RangeEvidence& e) {
  const Eigen::Vector<double, kSlants> values = e.values.tail<kSlants>();
  const Eigen::Matrix<double, kSlants, kSlants> covariance =
      e.covariance.bottomRightCorner<kSlants, kSlants>();
  return values.dot(covariance.ldlt().solve(values));
}

/// Noise is not known well enough for probabilities below 1e-12 to mean anything.
double chance(double statistic, double degrees) {
  return std::max(boost::math::gamma_q(degrees / 2.0, statistic / 2.0), 1e-12);
}

}  // namespace

RangeErrorTerms by_coefficient(const terms::Sighting& sighting) {
  const auto of_incidence = slants(sighting);
  RangeErrorTerms dependence;
  dependence << 1.0, of_incidence[0], of_incidence[1], of_incidence[2], of_incidence[3];
  return dependence;
}

bool shows_offset(const RangeEvidence& e) {
  return std::abs(e.values(0)) > settings::kLeastRangeError_m &&
         offset_in_sigmas(e) > settings::kRangeErrorSigmas &&
         std::abs(e.values(0) - e.offset_alone) < settings::kMostOffsetChange * std::abs(e.values(0));
}

bool matters_at_a_slant(const RangeErrorTerms& dependence) {
  const double at_45_degrees = dependence(1) + settings::kUsualDistance_m * dependence(3);
  return std::abs(at_45_degrees) > settings::kLeastRangeError_m;
}

bool shows_slant(const RangeEvidence& e) {
  return matters_at_a_slant(e.values) &&
         slant_statistic(e) > settings::kRangeErrorSigmas * settings::kRangeErrorSigmas + kSlants;
}

double p_value_of_offset(const RangeEvidence& e) { return chance(std::pow(offset_in_sigmas(e), 2), 1.0); }

double p_value_of_slant(const RangeEvidence& e) { return chance(slant_statistic(e), kSlants); }

}  // namespace odomcalib::calib::measurement
