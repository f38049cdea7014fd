// The base parameters of a robot with two driven wheels and a lidar. Their names, units, frames and meanings
// stand in this table alone; code uses the identifiers.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "proto/measurements.hpp"

namespace odomcalib {

/// In the order of files, covariances and tables.
enum class BaseQuantity {
  left_wheel_diameter,
  right_wheel_diameter,
  track_width,
  lidar_x,
  lidar_y,
  lidar_yaw
};

struct BaseQuantityRow {
  BaseQuantity id;
  const char* name;    ///< in files, messages and commands; people read it without underscores
  const char* symbol;  ///< in the mathematics
  const char* unit;    ///< "m" or "rad": how people see it follows from that
  const char* frame;   ///< that the value is stated in
  double per_fitted;   ///< the value over the one that is fitted: a diameter is two radii
  const char* meaning;
};

inline constexpr std::array<BaseQuantityRow, 6> kBaseQuantities{{
    {BaseQuantity::left_wheel_diameter, "left_wheel_diameter", "2 r_l", "m", "wheel", 2.0,
     "effective diameter of the left wheel: way per turn over pi, under load"},
    {BaseQuantity::right_wheel_diameter, "right_wheel_diameter", "2 r_r", "m", "wheel", 2.0,
     "effective diameter of the right wheel: way per turn over pi, under load"},
    {BaseQuantity::track_width, "track_width", "b", "m", "base", 1.0,
     "effective distance of the points that the wheels roll on, along y"},
    {BaseQuantity::lidar_x, "lidar_x", "l_x", "m", "base", 1.0,
     "place of the lidar ahead of the middle of the axle"},
    {BaseQuantity::lidar_y, "lidar_y", "l_y", "m", "base", 1.0,
     "place of the lidar to the left of the middle of the axle"},
    {BaseQuantity::lidar_yaw, "lidar_yaw", "l_yaw", "rad", "base", 1.0,
     "direction of the lidar's own x, counter-clockwise from ahead"},
}};

/// The lengths that odometry is made of, and the only ones that a controller may hold.
inline constexpr std::array kDriveLengths = {BaseQuantity::left_wheel_diameter,
                                             BaseQuantity::right_wheel_diameter, BaseQuantity::track_width};
/// x, y, yaw of the lidar in the frame of the base.
inline constexpr std::array kLidarPoseQuantities = {BaseQuantity::lidar_x, BaseQuantity::lidar_y,
                                                    BaseQuantity::lidar_yaw};

constexpr const BaseQuantityRow& row_of(BaseQuantity quantity) {
  return kBaseQuantities[static_cast<std::size_t>(quantity)];
}

constexpr const char* name_of(BaseQuantity quantity) { return row_of(quantity).name; }

/// nullopt for what is no base parameter, as a parameter of an effect.
constexpr std::optional<BaseQuantity> base_quantity_from(std::string_view name) {
  for (const BaseQuantityRow& row : kBaseQuantities)
    if (name == row.name) return row.id;
  return std::nullopt;
}

/// @param name of a parameter, whichever a file states
constexpr bool is_name_of(std::string_view name, BaseQuantity quantity) { return name == name_of(quantity); }

constexpr bool is_drive_length(BaseQuantity quantity) {
  return std::find(kDriveLengths.begin(), kDriveLengths.end(), quantity) != kDriveLengths.end();
}

/// @param name of a parameter, whichever a file states
constexpr bool is_drive_length(std::string_view name) {
  const auto quantity = base_quantity_from(name);
  return quantity && is_drive_length(*quantity);
}

constexpr bool is_wheel_diameter(BaseQuantity quantity) { return row_of(quantity).per_fitted == 2.0; }

/// Member of a robot's description; null for those of the lidar, whose pose is one member.
constexpr double RobotDescription::*member_of(BaseQuantity quantity) {
  switch (quantity) {
    case BaseQuantity::left_wheel_diameter:
      return &RobotDescription::left_wheel_diameter;
    case BaseQuantity::right_wheel_diameter:
      return &RobotDescription::right_wheel_diameter;
    case BaseQuantity::track_width:
      return &RobotDescription::track_width;
    default:
      return nullptr;
  }
}

/// Nominal value, m or rad; nullopt where nobody stated one: a length of zero is none.
inline std::optional<double> nominal_value(const RobotDescription& robot, BaseQuantity quantity) {
  if (const auto member = member_of(quantity))
    return robot.*member > 0.0 ? std::optional(robot.*member) : std::nullopt;
  if (!robot.lidar_pose) return std::nullopt;
  const auto& [x, y, yaw] = *robot.lidar_pose;
  if (quantity == BaseQuantity::lidar_x) return x;
  return quantity == BaseQuantity::lidar_y ? y : yaw;
}

}  // namespace odomcalib
