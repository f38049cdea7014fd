// Parts that a topic can be taken as, and descriptions of topics. Internal to proto/.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/recording/ros/collector.hpp"

namespace odomcalib::ros {

enum class Part : std::uint8_t { scan, wheels, wheel_speeds, odometry, gyro, pose };
inline constexpr std::array<const char*, 6> kParts{"scan",     "wheels", "wheel_speeds",
                                                   "odometry", "gyro",   "pose"};

std::optional<Part> part_named(const std::string& name);
std::string name_of(Part part);

/// Whether the messages of a topic can be the part.
bool serves(const Topic& topic, Part part);
/// The kind that a topic of an unknown type is read as when it is chosen as the part.
Kind kind_for(Part part);
/// The part that the name of a topic suggests.
std::optional<Part> part_by_name(const std::string& topic);
/// The types that can be the part, for people.
std::string types_for(Part part);

/// "a, b, c"; "none" without any.
std::string joined(const std::vector<std::string>& words);
/// Name, type and count.
std::string described(const Topic& topic);
/// List of topics, of hundreds only the first ones; those that can be read come before all others.
std::string list_of(const std::vector<Topic>& topics);

}  // namespace odomcalib::ros
