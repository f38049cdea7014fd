// The wheels among the joints of a topic. Internal to proto/.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "proto/recording/ros/collector.hpp"
#include "proto/recording/wheel_joining.hpp"

namespace odomcalib::ros {

struct Joints {
  std::string left, right;
};

/// The wheels that drive and are not steered, as far as names tell.
struct NamedWheels {
  Joints taken;
  std::optional<Joints> front;  ///< where `taken` is the rear pair of four wheels
};

/// Every name that a message of the topic had, once.
std::vector<std::string> joint_names(const Topic& topic);
/// The same for people, not all of a robot with many arms.
std::string names_of_joints(const Topic& topic);
std::string names_of_joints(const std::vector<std::string>& names);

/// The wheels, where the names tell them: one name with left and one with right, or a rear and a front pair.
std::optional<NamedWheels> wheels_by_name(const Topic& topic);

/// The only wheel of a topic that has one wheel only; the side by the name of the joint, else of the topic.
struct NamedWheel {
  Side side;
  std::string joint;
};
std::optional<NamedWheel> wheel_by_name(const Topic& topic);

/// Places of the left and the right joint in each list of names.
using Places = std::array<std::optional<std::size_t>, 2>;
std::vector<Places> places(const Topic& topic, const Joints& joints);

/// How far the front wheels turn otherwise than the rear ones, left and right, as a share of their way;
/// nothing where they do not turn.
std::optional<std::array<double, 2>> unlike(const Topic& topic, const NamedWheels& wheels);

}  // namespace odomcalib::ros
