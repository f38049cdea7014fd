// Which scans of a drive become vertices of its graph.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "calib/math/se2.hpp"
#include "calib/slam/settings.hpp"

namespace odomcalib::calib::slam {

struct KeyframeSpacing {
  double distance = settings::kKeyframeDistance_m;    ///< m of travel, or ...
  double rotation = settings::kKeyframeRotation_rad;  ///< rad turned either way
};

/// The first pose, and each after which one of the two is reached since the last one chosen. Travel and turn
/// are those of the path, so that a robot that comes back in between is noticed.
std::vector<std::size_t> choose_keyframes(std::span<const math::Pose> odometry,
                                          const KeyframeSpacing& spacing);

}  // namespace odomcalib::calib::slam
