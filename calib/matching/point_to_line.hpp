// Point-to-line scan matching. A. Censi: An ICP variant using a point-to-line metric, ICRA 2008; here with
// lines fitted to neighbourhoods instead of two points, so that the reference scan's noise is averaged. What
// it finds is refined on whole walls (joint_lines.hpp), wherever walls carry the match.
#pragma once

#include <Eigen/Core>
#include <string>

#include "calib/matching/nearest.hpp"
#include "calib/matching/settings.hpp"
#include "calib/matching/surface.hpp"
#include "calib/matching/walls.hpp"

namespace odomcalib::calib::matching {

enum class MatchStatus {
  ok,
  too_few_points,  ///< a scan has too few readings on surfaces
  no_overlap,      ///< too few correspondences, or they do not agree
  degenerate,      ///< one direction of motion is not observable (corridor, round room); see weak_direction
  not_converged,
};
std::string to_string(MatchStatus status);

struct MatchOptions {
  double range_noise = settings::kUsualRangeNoise_m;  ///< m, standard deviation of one range
  double max_distance = settings::kFirstDistance_m;   ///< m, first gate for correspondences
  double min_overlap = settings::kLeastOverlap;       ///< share of usable points that must find a partner
  /// Least eigenvalue ratio of the translation information; below: degenerate.
  double min_eigenvalue_ratio = settings::kDegenerateRatio;
  int max_iterations = settings::kMostMatchSteps;
  bool guess_is_near = false;  ///< by a match before: the way from afar is spared
  bool wants_part = false;     ///< a match that leaves a direction open is of use, too: both ways of it
  /// Information of the guess: x, y, yaw, in 1/m^2, 1/(m rad), 1/rad^2. Zero: the guess is a start and no
  /// prior. With it a scan does not slide along a corridor.
  Eigen::Matrix3d guess_information = Eigen::Matrix3d::Zero();
};

struct MatchResult {
  MatchStatus status = MatchStatus::not_converged;
  math::Pose motion;  ///< of the sensor, in the frame of the reference scan
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< x, y, yaw of `motion`; m^2, m rad, rad^2
  /// Information of the scans alone, free of the guess; not positive definite if a direction is unobservable.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  std::size_t inliers = 0;        ///< points of the scan that agree with lines of the reference
  double overlap = 0.0;           ///< share of usable points that are inliers
  double eigenvalue_ratio = 0.0;  ///< smallest to largest eigenvalue of the translation information
  Eigen::Vector2d weak_direction = Eigen::Vector2d::Zero();  ///< eigenvector of the smallest one
  double residual = 0.0;  ///< robust sigma of the point-to-line distances in units of their expectation
  int iterations = 0;
  bool converged = false;
  [[nodiscard]] bool is_usable() const { return status == MatchStatus::ok; }
  /// Usable, but for the weak direction.
  [[nodiscard]] bool is_partial() const { return status == MatchStatus::degenerate && converged; }
};

/// Where a surface's beams end, in its frame.
std::vector<Eigen::Vector2d> positions(const Surface& surface);

/// A reference scan prepared once for several matches.
class MatchReference {
 public:
  MatchReference(Surface surface, double range_noise);
  [[nodiscard]] const Surface& surface() const { return surface_; }
  [[nodiscard]] const Walls& walls() const { return walls_; }
  /// The surface's points in order of bearing.
  [[nodiscard]] const BearingOrder& order() const { return order_; }

 private:
  Surface surface_;
  Walls walls_;
  BearingOrder order_;
};

/// Motion from `reference` to `scan`, starting at `guess`. Without `guess_information` the result does not
/// depend on the guess within the basin of convergence.
MatchResult match_point_to_line(const MatchReference& reference, const Surface& scan, const math::Pose& guess,
                                const MatchOptions& options);

/// Corridors and round rooms: one direction of motion, or the rotation, leaves no trace in the readings.
struct Observability {
  double ratio = 0.0;  ///< smallest to largest eigenvalue of the information about translation
  Eigen::Vector2d weak_direction = Eigen::Vector2d::Zero();  ///< eigenvector of the smallest one
};

/// Observability of the translation, yaw eliminated (Schur complement). Ratio 0 when nothing is known of yaw.
/// @param information of x, y, yaw
Observability observability(const Eigen::Matrix3d& information);

}  // namespace odomcalib::calib::matching
