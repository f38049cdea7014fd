#include "calib/slam/loop_check.hpp"

#include <algorithm>
#include <cmath>

#include "calib/matching/pose_search.hpp"
#include "calib/math/vector2.hpp"
#include "calib/slam/settings.hpp"

namespace odomcalib::calib::slam {
namespace {

std::size_t bin_of(double angle) {
  const double turns = angle / (2.0 * math::kPi);
  return static_cast<std::size_t>((turns - std::floor(turns)) * settings::kFreeSpaceBins) %
         settings::kFreeSpaceBins;
}

/// The four windows that lie about the summit, clear of it, as far as the search went.
bool has_competitor(matching::LikelihoodField& field, const std::vector<Eigen::Vector2d>& points,
                    const matching::SearchResult& best, const LoopCheckOptions& options) {
  const double half = 0.5 * (options.half_width - settings::kSummit_m);
  if (!(half > field.cell())) return false;
  const double away = settings::kSummit_m + half;
  for (const auto& [dx, dy] : {std::pair{away, 0.0}, {-away, 0.0}, {0.0, away}, {0.0, -away}}) {
    const matching::SearchWindow window{
        {best.pose.x + dx, best.pose.y + dy, best.pose.yaw}, half, options.half_angle};
    if (search_branch_and_bound(field, points, window).score > options.competitor * best.score) return true;
  }
  return false;
}

LoopMatch refused(const std::string& reason) {
  LoopMatch match;
  match.reason = reason;
  return match;
}

}  // namespace

FreeSpace::FreeSpace(const matching::Surface& surface) : ranges_(settings::kFreeSpaceBins, 0.0) {
  for (const matching::SurfacePoint& point : surface.points) {
    const std::size_t bin = bin_of(std::atan2(point.position.y(), point.position.x()));
    const double range = point.position.norm();
    ranges_[bin] = ranges_[bin] > 0.0 ? std::min(ranges_[bin], range) : range;
  }
}

double FreeSpace::range_towards(double angle) const { return ranges_[bin_of(angle)]; }

double intrusion(const FreeSpace& seen, const std::vector<Eigen::Vector2d>& points,
                 const math::Pose& motion) {
  const math::Frame frame(motion);
  std::size_t looked_at = 0, inside = 0;
  for (const Eigen::Vector2d& p : points) {
    const Eigen::Vector2d at = frame.transform(p);
    const double range = seen.range_towards(std::atan2(at.y(), at.x()));
    if (!(range > 0.0)) continue;
    ++looked_at;
    if (at.norm() < range - settings::kClearance_m) ++inside;
  }
  return looked_at == 0 ? 0.0 : static_cast<double>(inside) / static_cast<double>(looked_at);
}

LoopMatch match_loop(const matching::MatchReference& first, const matching::Surface& second,
                     const math::Pose& guess, const LoopCheckOptions& options,
                     std::span<const Eigen::Vector2d> seen_about) {
  const auto reference_points = positions(first.surface());
  const auto points = positions(second);
  if (points.size() < settings::kFewestLoopPoints || reference_points.size() < settings::kFewestLoopPoints)
    return refused("too few readings");
  std::vector<Eigen::Vector2d> place = reference_points;
  place.insert(place.end(), seen_about.begin(), seen_about.end());
  matching::LikelihoodField field(place, {});
  const auto few = matching::thinned(points, settings::kLoopSearchPoints);
  const matching::SearchResult best =
      search_branch_and_bound(field, few, {guess, options.half_width, options.half_angle});
  matching::MatchOptions match_options;
  match_options.range_noise = options.range_noise;
  match_options.min_overlap = options.min_overlap;
  const matching::MatchResult found = match_point_to_line(first, second, best.pose, match_options);
  if (!found.is_usable()) return refused(to_string(found.status));
  if (found.residual > settings::kMostLoopResidual) return refused("surfaces do not agree");
  if (intrusion(FreeSpace(first.surface()), points, found.motion) > options.max_intrusion ||
      intrusion(FreeSpace(second), reference_points, inverse(found.motion)) > options.max_intrusion)
    return refused("walls where the other scan saw free space");
  if (has_competitor(field, few, best, options)) return refused("ambiguous");
  return {true, "", found.motion, found.covariance, found.overlap};
}

}  // namespace odomcalib::calib::slam
