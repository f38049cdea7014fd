// Point-to-point scan matching. P. Besl and N. McKay: A method for registration of 3-D shapes, PAMI 1992. Two
// scans never hit the same spot twice, so that on walls this is off by millimetres whatever the noise: the
// yardstick beside point-to-line matching, not a replacement.
#pragma once

#include <Eigen/Core>
#include <span>

#include "calib/matching/nearest.hpp"
#include "calib/matching/settings.hpp"
#include "calib/math/se2.hpp"

namespace odomcalib::calib::matching {

struct IcpOptions {
  double max_distance = settings::kIcpDistance_m;  ///< m, correspondences farther apart are left out
  double min_overlap = settings::kIcpOverlap;      ///< share of the points that must find a partner
  int max_iterations = settings::kMostIcpSteps;
};

struct IcpResult {
  math::Pose motion;
  double rms = 0.0;      ///< m, of the correspondences
  double overlap = 0.0;  ///< share of the points with a partner
  bool converged = false;
};

/// The motion that moves `from` onto `onto` best in the sense of least squares, point i onto point i (Arun,
/// Huang and Blostein, PAMI 1987, in closed form for the plane). Both must hold the same number of points.
math::Pose align_points(std::span<const Eigen::Vector2d> from, std::span<const Eigen::Vector2d> onto);

/// `converged` only with enough overlap: nothing that merely stands still passes for a match.
IcpResult match_point_to_point(const NearestTree& reference, std::span<const Eigen::Vector2d> scan,
                               const math::Pose& guess, const IcpOptions& options);

}  // namespace odomcalib::calib::matching
