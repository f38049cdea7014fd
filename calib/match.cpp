#include "calib/match.hpp"

#include "calib/matching/both_ways.hpp"
#include "calib/matching/pose_search.hpp"
#include "calib/settings.hpp"

namespace odomcalib::calib {
namespace {

matching::MatchResult match_after_search(const matching::MatchReference& reference,
                                         const matching::MatchReference& scan, const math::Pose& guess,
                                         const matching::MatchOptions& options) {
  matching::LikelihoodField field(positions(reference.surface()), matching::FieldOptions{});
  const auto points = matching::thinned(positions(scan.surface()), settings::kSearchPoints);
  const matching::SearchResult start = search_branch_and_bound(field, points, {.centre = guess});
  return match_both_ways(reference, scan, start.pose, options);
}

/// The match from the guess, or from a search around it when the guess did not
/// lead to a convincing one.
matching::MatchResult match_best(const matching::MatchReference& reference,
                                 const matching::MatchReference& scan, const math::Pose& guess,
                                 const matching::MatchOptions& options) {
  matching::MatchResult first = match_both_ways(reference, scan, guess, options);
  if (first.status == matching::MatchStatus::too_few_points) return first;
  if (first.is_usable() && first.overlap >= settings::kConvincing) return first;
  matching::MatchResult second = match_after_search(reference, scan, guess, options);
  // Refused or not, the pose with more agreement says more about the pair.
  return second.inliers > first.inliers ? second : first;
}

ScanMatch describe(const matching::MatchResult& result) {
  ScanMatch match;
  match.status = to_string(result.status);
  match.inliers = result.inliers;
  if (result.status == matching::MatchStatus::degenerate)
    match.weak_direction = {result.weak_direction.x(), result.weak_direction.y()};
  if (!match.ok()) return match;
  match.pose = {result.motion.x, result.motion.y, result.motion.yaw};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      match.covariance[i][j] = result.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  return match;
}

}  // namespace

ScanMatch match_scans(const Scan& reference, const Scan& scan, const std::array<double, 3>& guess,
                      std::optional<double> range_noise) {
  const Scan both[] = {reference, scan};
  matching::MatchOptions options;
  options.range_noise = range_noise.value_or(matching::estimate_range_noise(both));
  const matching::BeamMotion at_rest = [](double) { return math::Pose{}; };
  const matching::MatchReference prepared(matching::make_surface(reference, at_rest, options.range_noise),
                                          options.range_noise);
  const matching::MatchReference other(matching::make_surface(scan, at_rest, options.range_noise),
                                       options.range_noise);
  return describe(match_best(prepared, other, {guess[0], guess[1], guess[2]}, options));
}

ScanMatch search_scans(const Scan& reference, const Scan& scan, const std::array<double, 3>& guess,
                       Matcher matcher) {
  const Scan both[] = {reference, scan};
  const double noise = matching::estimate_range_noise(both);
  const matching::BeamMotion at_rest = [](double) { return math::Pose{}; };
  const auto wanted = positions(matching::make_surface(reference, at_rest, noise));
  const auto points =
      matching::thinned(positions(matching::make_surface(scan, at_rest, noise)), settings::kSearchPoints);
  ScanMatch match;
  match.status = to_string(matching::MatchStatus::too_few_points);
  if (wanted.size() < settings::kFewestScored || points.size() < settings::kFewestScored) return match;
  const matching::LikelihoodField field(wanted, {});
  const math::Pose start{guess[0], guess[1], guess[2]};
  const matching::SearchResult found = matcher == Matcher::brute
                                           ? search_brute_force(field, points, {.centre = start})
                                           : search_hill_climb(field, points, start, {});
  match.status = to_string(matching::MatchStatus::ok);
  match.pose = {found.pose.x, found.pose.y, found.pose.yaw};
  match.score = found.score;
  match.inliers = points.size();
  return match;
}

}  // namespace odomcalib::calib
