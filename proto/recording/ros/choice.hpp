// Which topic is what. Internal to proto/.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "proto/recording/recording.hpp"
#include "proto/recording/ros/joints.hpp"
#include "proto/recording/ros/parts.hpp"

namespace odomcalib::ros {

struct Chosen {
  std::array<Topic*, kParts.size()> topics{};  // by part
  Joints joints;
  Topic*& operator[](Part part) { return topics.at(static_cast<std::size_t>(part)); }
};

/// What the user chose, and of the rest what is unique. Error: usage, or empty (no wheel motion).
/// @param remarks what else there was, and how to take it
Result<Chosen> choose_topics(Collector& collector, const TopicChoices& choices, const std::string& where,
                             std::vector<std::string>& remarks);

}  // namespace odomcalib::ros
