#include "calib/odometry/path_noise.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "calib/math/vector2.hpp"

namespace odomcalib::calib::odometry {

std::array<double, 3> deviation_at_end(std::span<const PoseSample> path, const IncrementNoise& noise,
                                       double track_width) {
  const Eigen::Vector3d per_metre = Eigen::Vector3d(noise[0], noise[1], noise[2]).cwiseAbs2();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t k = 1; k < path.size(); ++k) {
    const double dx = path[k].x - path[k - 1].x;
    const double dy = path[k].y - path[k - 1].y;
    // Mean of both wheels, whichever way each rolls.
    const double rolled =
        std::max(std::hypot(dx, dy), 0.5 * track_width * std::abs(path[k].yaw - path[k - 1].yaw));
    // An error of the heading moves all that follows sideways; that of the increment is in its own frame.
    Eigen::Matrix3d carried = Eigen::Matrix3d::Identity();
    carried(0, 2) = -dy;
    carried(1, 2) = dx;
    const Eigen::Matrix3d turn = math::rotation_about_z(path[k - 1].yaw);
    covariance = carried * covariance * carried.transpose() +
                 rolled * (turn * per_metre.asDiagonal() * turn.transpose());
  }
  return {std::sqrt(covariance(0, 0)), std::sqrt(covariance(1, 1)), std::sqrt(covariance(2, 2))};
}

}  // namespace odomcalib::calib::odometry
