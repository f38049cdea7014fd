// Scans of rooms made of straight walls, for tests of matching.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "calib/math/se2.hpp"
#include "proto/measurements.hpp"

namespace odomcalib::test_support {

struct RoomWall {
  double x1, y1, x2, y2;
};

inline double ray_distance(const std::vector<RoomWall>& walls, double x, double y, double angle) {
  double nearest = 1e9;
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  for (const RoomWall& w : walls) {
    const double ex = w.x2 - w.x1;
    const double ey = w.y2 - w.y1;
    const double determinant = c * ey - s * ex;
    if (std::abs(determinant) < 1e-12) continue;
    const double along_ray = ((w.x1 - x) * ey - (w.y1 - y) * ex) / determinant;
    const double along_wall = ((w.x1 - x) * s - (w.y1 - y) * c) / determinant;
    if (along_ray > 0.0 && along_wall >= 0.0 && along_wall <= 1.0) nearest = std::min(nearest, along_ray);
  }
  return nearest;
}

inline const std::vector<RoomWall> kRoom = {{-3, -2, 4, -2}, {4, -2, 4, 3}, {4, 3, -3, 3},
                                            {-3, 3, -3, -2}, {1, 3, 1, 2},  {1, 2, 2, 2}};
inline const std::vector<RoomWall> kHall = {{-6, -5, 5, -5}, {5, -5, 5, 4}, {5, 4, -6, 4}, {-6, 4, -6, -5}};
inline const std::vector<RoomWall> kCorridor = {{-50, -1, 50, -1}, {-50, 1, 50, 1}};

inline Scan scan_from(const std::vector<RoomWall>& walls, const calib::math::Pose& pose, double noise,
                      unsigned seed, int beams = 720) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> gauss(0.0, noise);
  Scan scan;
  scan.angle_min = -calib::math::kPi;
  scan.angle_increment = 2.0 * calib::math::kPi / beams;
  scan.range_max = 12.0;
  for (int i = 0; i < beams; ++i) {
    const double range =
        ray_distance(walls, pose.x, pose.y, pose.yaw + scan.angle_min + scan.angle_increment * i);
    scan.ranges.push_back(range < 12.0 ? static_cast<float>(range + (noise > 0.0 ? gauss(engine) : 0.0))
                                       : 0.0F);
  }
  return scan;
}

}  // namespace odomcalib::test_support
