// A robot's description (URDF, wiki.ros.org/urdf/XML/joint), as /robot_description has it. Internal to
// proto/.
#pragma once

#include <optional>
#include <string>

#include "proto/recording/ros/messages.hpp"

namespace odomcalib::ros {

/// The joints that do not move, each as the pose of its child in its parent. Joints whose numbers are none or
/// that lack a link are counted. Nothing where the text is no URDF.
std::optional<Transforms> fixed_joints(const std::string& urdf);

}  // namespace odomcalib::ros
