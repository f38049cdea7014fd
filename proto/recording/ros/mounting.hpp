// Where the lidar sits on the base, by the transforms of /tf_static or a description. Internal to proto/.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "proto/recording/ros/messages.hpp"

namespace odomcalib::ros {

struct Mounting {
  std::string base;              ///< frame
  std::array<double, 3> pose{};  ///< x, y [m], yaw [rad] of the lidar in it
  bool upright = true;           ///< within a few degrees; else its pose in the plane means nothing
};

/// @param bases frames that may be the robot's base, the likeliest first
/// @param lidar frame of the scans
/// @return nullopt where no chain of transforms leads from one of the bases to the lidar
std::optional<Mounting> mounting_of(const std::vector<Transform>& transforms,
                                    const std::vector<std::string>& bases, const std::string& lidar);

}  // namespace odomcalib::ros
