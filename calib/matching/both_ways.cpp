#include "calib/matching/both_ways.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "calib/matching/settings.hpp"
#include "calib/math/linear_solve.hpp"

namespace odomcalib::calib::matching {
namespace {

/// Information of a motion's inverse, by the derivative of its x, y, yaw by those of the motion.
Eigen::Matrix3d information_of_inverse(const math::Pose& motion, const Eigen::Matrix3d& information) {
  const double c = std::cos(motion.yaw), s = std::sin(motion.yaw);
  const math::Pose back = inverse(motion);
  Eigen::Matrix3d derivative;
  derivative << -c, -s, back.y, s, -c, -back.x, 0.0, 0.0, -1.0;
  const Eigen::Matrix3d inverted = derivative.inverse();
  return inverted.transpose() * information * inverted;
}

math::Pose mean(const math::Pose& a, const math::Pose& b) {
  const math::Pose apart = between(a, b);
  return compose(a, math::Pose{0.5 * apart.x, 0.5 * apart.y, 0.5 * math::wrap_angle(apart.yaw)});
}

/// The motion is the mean of both ways, the information that of a mean of two alike.
void take_mean(MatchResult& result, const MatchResult& back) {
  const math::Pose there = inverse(back.motion);
  const Eigen::Matrix3d sum = result.information + information_of_inverse(back.motion, back.information);
  result.motion = mean(result.motion, there);
  result.information = sum / (1.0 + settings::kBothWaysCorrelation);
  result.covariance = math::inverse_symmetric(result.information);
}

}  // namespace

MatchResult match_both_ways(const MatchReference& first, const MatchReference& second,
                            const math::Pose& guess, const MatchOptions& options) {
  MatchResult result = match_point_to_line(first, second.surface(), guess, options);
  if (!result.is_usable() && !(options.wants_part && result.is_partial())) return result;
  MatchOptions back_options = options;
  back_options.guess_information = information_of_inverse(guess, options.guess_information);
  // With a prior about the guess the way back has to begin there, too.
  const bool has_prior = !options.guess_information.isZero();
  const math::Pose start = inverse(has_prior ? guess : result.motion);
  back_options.guess_is_near = !has_prior;
  const MatchResult back = match_point_to_line(second, first.surface(), start, back_options);
  if (back.status == result.status && back.converged) take_mean(result, back);
  return result;
}

}  // namespace odomcalib::calib::matching
