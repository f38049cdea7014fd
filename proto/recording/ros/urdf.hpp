// A robot's description (URDF, wiki.ros.org/urdf/XML/joint), as /robot_description has it. Internal to
// proto/.
#pragma once

#include <string>
#include <vector>

#include "proto/recording/ros/messages.hpp"

namespace odomcalib::ros {

/// The joints that do not move, each as the pose of its child in its parent. Joints whose numbers are none
/// are left out. Empty also where the text is no URDF.
std::vector<Transform> fixed_joints(const std::string& urdf);

}  // namespace odomcalib::ros
