// Corridors and round rooms: one direction of motion, or the rotation, leaves no trace in the readings.
#pragma once

#include <Eigen/Core>

namespace odomcalib::calib::matching {

struct Observability {
  double ratio = 0.0;  ///< smallest to largest eigenvalue of the information about translation
  Eigen::Vector2d weak_direction = Eigen::Vector2d::Zero();  ///< eigenvector of the smallest one
};

/// Of the translation once yaw is eliminated (Schur complement). Ratio 0 when nothing is known about yaw.
/// @param information of x, y, yaw
Observability observability(const Eigen::Matrix3d& information);

}  // namespace odomcalib::calib::matching
