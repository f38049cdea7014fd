#include "calib/match.hpp"

#include "calib/matching/point_to_line.hpp"

namespace odomcalib::calib {

ScanMatch match_scans(const Scan& reference, const Scan& scan, const std::array<double, 3>& guess,
                      std::optional<double> range_noise) {
  const Scan both[] = {reference, scan};
  MatchOptions options;
  options.range_noise = range_noise.value_or(estimate_range_noise(both));
  const BeamMotion at_rest = [](double) { return Pose{}; };
  const MatchReference prepared(make_surface(reference, at_rest, options.range_noise), options.range_noise);
  const Surface surface = make_surface(scan, at_rest, options.range_noise);
  const MatchResult result = match_point_to_line(prepared, surface, {guess[0], guess[1], guess[2]}, options);
  ScanMatch match;
  match.status = to_string(result.status);
  match.inliers = result.inliers;
  if (!match.ok()) return match;
  match.pose = {result.motion.x, result.motion.y, result.motion.yaw};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      match.covariance[i][j] = result.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  return match;
}

}  // namespace odomcalib::calib
