// Whether two scans that match really show the same place.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "calib/matching/point_to_line.hpp"
#include "calib/matching/settings.hpp"
#include "calib/slam/settings.hpp"

namespace odomcalib::calib::slam {

/// Range by direction, in half-degree bins: how far a scan saw free space.
class FreeSpace {
 public:
  explicit FreeSpace(const matching::Surface& surface);
  /// m; 0 where the scan saw nothing.
  [[nodiscard]] double range_towards(double angle) const;

 private:
  std::vector<double> ranges_;
};

struct LoopMatch {
  bool ok = false;
  std::string reason;  ///< why not
  math::Pose motion;   ///< of the second scan in the frame of the first
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double overlap = 0.0;  ///< share of the second scan's lines that found their partner
};

struct LoopCheckOptions {
  double range_noise = matching::settings::kUsualRangeNoise_m;  ///< m
  double half_width = settings::kLoopHalfWidth_m;               ///< m, of the search for the motion
  double half_angle = settings::kLoopHalfAngle_rad;             ///< rad
  /// Share of the scan's lines that find their partner.
  double min_overlap = settings::kLoopOverlap;
  /// Share of points of one scan in what the other saw as free.
  double max_intrusion = settings::kMostIntrusion;
  /// A far pose that fits this well compared with the best one makes the match ambiguous.
  double competitor = settings::kCompetitorScore;
};

/// Searches for the motion about `guess`, refines it and questions the result.
/// @param seen_about points of the place in the frame of the first scan, as other scans saw it from nearby:
/// the search counts on them, too, so that what the first scan did not see does not speak against the truth
LoopMatch match_loop(const matching::MatchReference& first, const matching::Surface& second,
                     const math::Pose& guess, const LoopCheckOptions& options,
                     std::span<const Eigen::Vector2d> seen_about = {});

/// Share of `points` (moved by `motion`) that lie clearly in front of what `seen` saw there.
double intrusion(const FreeSpace& seen, const std::vector<Eigen::Vector2d>& points, const math::Pose& motion);

}  // namespace odomcalib::calib::slam
