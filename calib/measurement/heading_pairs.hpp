// Pairs of scans taken at nearly the same place in clearly different directions: there a point of the room is
// seen at another bearing, range and incidence, and what the sensor does wrong does not cancel.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/measurement/scan_surfaces.hpp"
#include "calib/terms/lidar_effect.hpp"

namespace odomcalib::calib::measurement {

/// One point of the room in both scans.
struct DoubleSighting {
  terms::Sighting first, second;
  Eigen::Vector2d first_beam, second_beam;  ///< unit vectors in the first scan's frame
  Eigen::Vector2d normal;                   ///< of the surface, in the first scan's frame
  Eigen::Vector2d arm;     ///< from the second sensor to its point, in the first scan's frame
  double distance = 0.0;   ///< m, of the second point from the first scan's line
  double deviation = 0.0;  ///< m, expected of that distance
};

struct HeadingPair {
  std::size_t from = 0, to = 0;  ///< scans
  std::vector<DoubleSighting> points;
};

/// @return at most `most` pairs, each scan in one of them, in the order of time
std::vector<HeadingPair> heading_pairs(const ScanSurfaces& scans, std::size_t most);

}  // namespace odomcalib::calib::measurement
