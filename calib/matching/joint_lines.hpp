// Motion between two scans with the walls as unknowns: every wall is a line through the readings of both
// scans, and the motion is the one for which those lines fit best. Each reading counts once and with its own
// noise, so that the estimate is as good as the pair of scans allows and its covariance is right.
//
// A line fitted to one scan alone would do two kinds of harm. Its own error counts as if it were known, and
// its tilt pulls points along the wall. Lu and Milios, Autonomous Robots 4 (1997), and Censi, ICRA 2007, have
// the bound for a known map; with lines as nuisance parameters (Schur complement) it is twice that in
// variance.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/matching/walls.hpp"
#include "calib/math/vector2.hpp"

namespace odomcalib::calib::matching {

/// A point of the second scan that lies on a wall of the first.
struct WallPoint {
  Eigen::Vector2d position;  ///< in the second scan's frame
  std::size_t wall = 0;
  double variance = 0.0;                             ///< of its distance from the wall, m^2
  Eigen::Vector2d spread = Eigen::Vector2d::Zero();  ///< its beam times the deviation of the range, m
};

/// Prior knowledge of the motion.
struct GuessPrior {
  math::Pose guess;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  [[nodiscard]] Eigen::Vector3d gradient(const math::Pose& motion) const {
    return information * math::difference(motion, guess);
  }
};

struct JointEstimate {
  math::Pose motion;
  Eigen::Matrix3d information =
      Eigen::Matrix3d::Zero();  ///< of `motion`: x, y, yaw, without what is spurious
  std::size_t inliers = 0;
  double scale = 1.0;  ///< robust sigma of the distances in units of their expectation
  bool converged = false;
};

/// @return the prior is part of the motion and no part of the information
JointEstimate refine_on_walls(const Walls& reference, const std::vector<WallPoint>& points,
                              const math::Pose& start, const GuessPrior& prior = {});

}  // namespace odomcalib::calib::matching
