// Assignment of topics to the parts of a recording. Internal to proto/.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "proto/recording/recording.hpp"
#include "proto/recording/ros/joints.hpp"
#include "proto/recording/ros/parts.hpp"

namespace odomcalib::ros {

struct Chosen {
  std::array<Topic*, kParts.size()> topics{};  // by part
  Topic* right_wheel = nullptr;  // where each wheel has a topic of its own; the left one is in topics
  Joints joints;
  std::string odometry_there;  // a topic of it, taken or not
  Topic*& operator[](Part part) { return topics.at(static_cast<std::size_t>(part)); }
  Topic* operator[](Part part) const { return topics.at(static_cast<std::size_t>(part)); }
};

/// Every topic that is taken, once.
std::vector<Topic*> taken_topics(const Chosen& chosen);

/// Kinds that the chosen topics must have, by name: for those whose type the file does not say.
std::map<std::string, Kind> kinds_of(const TopicChoices& choices);

/// Topics that the user chose, and the unique ones of the rest. Error: usage, or empty (no wheel motion).
/// @param remarks what else there was, and how to take it
Result<Chosen> choose_topics(Collector& collector, const TopicChoices& choices, const std::string& where,
                             std::vector<std::string>& remarks);

}  // namespace odomcalib::ros
