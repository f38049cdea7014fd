// Search for the pose at which a scan fits best over a reference, when the first guess is too poor for
// point-to-line matching. Three ways to search the same score:
//  - brute force: every pose of a lattice, the yardstick for the others;
//  - branch and bound: the same optimum from a fraction of the work. W. Hess et al.: Real-time loop closure
//  in
//    2D lidar SLAM, ICRA 2016;
//  - hill climb: from one start, to the nearest summit only.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "calib/matching/likelihood_field.hpp"
#include "calib/matching/settings.hpp"
#include "calib/math/se2.hpp"

namespace odomcalib::calib::matching {

/// Poses about `centre`, both ends of each range included.
struct SearchWindow {
  math::Pose centre{};
  double half_width = settings::kSearchHalfWidth_m;    ///< m, in x and in y
  double half_angle = settings::kSearchHalfAngle_rad;  ///< rad
  double angle_step = settings::kSearchAngleStep_rad;  ///< rad; the step in x and y is the field's cell
};

struct SearchResult {
  math::Pose pose;
  double score = 0.0;         ///< mean over the points, 0 to 1
  std::size_t evaluated = 0;  ///< poses and sets of poses that were scored
};

/// Every few of the points, in order, so that no more than `most` remain.
std::vector<Eigen::Vector2d> thinned(std::span<const Eigen::Vector2d> points, std::size_t most);

SearchResult search_brute_force(const LikelihoodField& field, std::span<const Eigen::Vector2d> points,
                                const SearchWindow& window);

/// The score of brute force, always; the same pose unless several share that score. Makes the field's coarser
/// levels.
SearchResult search_branch_and_bound(LikelihoodField& field, std::span<const Eigen::Vector2d> points,
                                     const SearchWindow& window);

struct ClimbOptions {
  double step = settings::kClimbStep_m;          ///< m, first step in x and y
  double angle_step = settings::kClimbStep_rad;  ///< rad, first step in yaw
  int halvings = settings::kClimbHalvings;       ///< finer steps after no neighbour is better
};

/// To the better neighbour of six, again and again; never below the score of the start.
SearchResult search_hill_climb(const LikelihoodField& field, std::span<const Eigen::Vector2d> points,
                               const math::Pose& start, const ClimbOptions& options);

}  // namespace odomcalib::calib::matching
