// Which joints of a topic are the wheels. Internal to proto/.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "proto/recording/ros/collector.hpp"

namespace odomcalib::ros {

struct Joints {
  std::string left, right;
};

/// Every name that a message of the topic had, once.
std::vector<std::string> joint_names(const Topic& topic);

/// The wheels, where the names tell them.
std::optional<Joints> joints_by_name(const Topic& topic);

/// Places of both joints in each list of names; nothing where a list lacks one.
std::vector<std::optional<std::array<std::size_t, 2>>> places(const Topic& topic, const Joints& joints);

}  // namespace odomcalib::ros
