// A scan as beams: origin, direction and range of each, in the sensor's frame at the middle of the sweep.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/matching/surface.hpp"

namespace odomcalib::calib::measurement {

struct Beam {
  Eigen::Vector2d origin;     ///< m, where the sensor was when it shot
  Eigen::Vector2d direction;  ///< of length 1
  double range = 0.0;         ///< m
};

/// Beams with a usable reading.
/// @param motion of the sensor within the sweep
std::vector<Beam> make_beams(const Scan& scan, const matching::BeamMotion& motion);

}  // namespace odomcalib::calib::measurement
