// The topics of a ROS recording for who looks at it. Internal to proto/.
#pragma once

#include <string_view>
#include <vector>

#include "proto/recording/overview.hpp"
#include "proto/recording/ros/collector.hpp"

namespace odomcalib::ros {

/// In the order of the file.
std::vector<TopicOverview> overview_of(const std::vector<Topic>& topics);

/// "ROS bag", "MCAP" or "rosbag2 (sqlite3)", packed or not.
std::string container_name(std::string_view bytes);

}  // namespace odomcalib::ros
