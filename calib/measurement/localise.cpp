#include "calib/measurement/localise.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>

#include "calib/matching/point_to_line.hpp"
#include "calib/math/linear_solve.hpp"
#include "calib/math/median.hpp"
#include "calib/math/tukey.hpp"
#include "calib/math/vector2.hpp"
#include "calib/measurement/settings.hpp"
#include "calib/terms/lidar_smooth_term.hpp"

namespace odomcalib::calib::measurement {
namespace {

std::vector<RangeTerm> terms_within(const WallMap& map, const std::vector<Beam>& beams,
                                    const std::vector<Strike>& struck, const math::Pose& pose,
                                    const PlaceOptions& options, double gate, std::size_t& strikes) {
  std::vector<RangeTerm> terms;
  strikes = 0;
  terms.reserve(struck.size());
  const math::Frame frame(pose);
  for (const Strike& strike : struck) {
    const auto term = range_term(map, beams[strike.beam], strike.wall, frame, options);
    if (!term) continue;
    ++strikes;
    if (std::abs(term->residual) < gate) terms.push_back(*term);
  }
  return terms;
}

double last_gate(const PlaceOptions& options) {
  return std::max(settings::kLastPlaceGate_m, settings::kLastPlaceGateSigmas * options.range_noise);
}

double robust_scale(const std::vector<RangeTerm>& terms) {
  std::vector<double> sizes;
  sizes.reserve(terms.size());
  for (const RangeTerm& term : terms) sizes.push_back(std::abs(term.residual) / std::sqrt(term.variance));
  return std::max(1.0, math::kMadToSigma * math::median_of(std::move(sizes)));
}

bool is_apart(const math::Pose& a, const math::Pose& b) {
  return math::difference(a, b).cwiseAbs().maxCoeff() > settings::kSameStrikes;
}

/// One step, `share` of it taken; its whole length in sigmas.
double improve_place(const std::vector<RangeTerm>& terms, double share, Place& place) {
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  place.information.setZero();
  place.inliers = 0;
  for (const RangeTerm& term : terms) {
    const double weight = weight_of(term, place.scale);
    if (!(weight > 0.0)) continue;
    place.information += weight * term.by_pose * term.by_pose.transpose();
    gradient += weight * term.residual * term.by_pose;
    ++place.inliers;
  }
  const Eigen::Matrix3d damped =
      place.information + 1e-9 * (place.information.trace() + 1.0) * Eigen::Matrix3d::Identity();
  const Eigen::Vector3d step = math::solve_symmetric(damped, gradient);
  place.pose.x -= share * step(0);
  place.pose.y -= share * step(1);
  place.pose.yaw -= share * step(2);
  return std::sqrt(std::max(step.dot(place.information * step), 0.0));
}

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

std::optional<RangeTerm> range_term(const WallMap& map, const Beam& beam, std::size_t wall,
                                    const math::Frame& sensor, const PlaceOptions& options) {
  RangeTerm term = map.term(beam, wall, sensor, options.range_noise);
  if (term.sighting.range > matching::far_limit(options.range_max, options.range_noise)) return std::nullopt;
  if (!options.range_error.isZero()) term.residual -= options.range_error.dot(by_coefficient(term.sighting));
  return term;
}

std::vector<RangeTerm> fitting_terms(const WallMap& map, const std::vector<Beam>& beams,
                                     const math::Pose& sensor, const PlaceOptions& options) {
  std::size_t strikes = 0;
  return terms_within(map, beams, map.strikes(beams, sensor), sensor, options, last_gate(options), strikes);
}

double weight_of(const RangeTerm& term, double scale) {
  return math::tukey_weight(term.residual / (std::sqrt(term.variance) * scale) / math::kTukeyCut) /
         term.variance;
}

bool Place::is_usable() const {
  if (!converged || inliers < settings::kFewestInliers) return false;
  if (static_cast<double>(inliers) < settings::kLeastInliers * static_cast<double>(strikes)) return false;
  return matching::observability(information).ratio > settings::kLeastEigenvalue;
}

Place place_scan(const WallMap& map, const std::vector<Beam>& beams, const math::Pose& guess,
                 const PlaceOptions& options) {
  Place place;
  place.pose = guess;
  const double last = last_gate(options);
  std::vector<Strike> struck;
  math::Pose cast_from;
  for (int i = 0; i < options.iterations && !place.converged; ++i) {
    const double gate = std::max(options.gate * std::pow(settings::kPlaceGateShrinks, i), last);
    // A step so short leads few beams to another wall.
    if (i == 0 || is_apart(place.pose, cast_from)) {
      struck = map.strikes(beams, place.pose);
      cast_from = place.pose;
    }
    const auto terms = terms_within(map, beams, struck, place.pose, options, gate, place.strikes);
    if (terms.size() < settings::kFewestInliers) return place;
    place.scale = robust_scale(terms);
    // Beams next to the end of a wall may strike it and miss it in turn; half steps settle between.
    const double step = improve_place(terms, i < settings::kWholeSteps ? 1.0 : 0.5, place);
    place.converged = gate <= last && step < settings::kPlaceSettled * place.scale;
  }
  return place;
}

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
