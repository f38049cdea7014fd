// Dependences of a lidar's error that no named effect stands for.
#pragma once

#include <vector>

#include "calib/lidar/lidar_effect.hpp"

namespace odomcalib::calib {

/// One for each variable and direction of the displacement: "bearing", "range", "incidence".
std::vector<LidarEffectPtr> lidar_curves();

}  // namespace odomcalib::calib
