// Where a file of parameters for ROS holds those of ros2_control's diff_drive_controller, and how they
// change.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "daemon/cli/text_edit.hpp"
#include "proto/result.hpp"

namespace odomcalib::cli {

/// The place is the one mapping that has both wheel_separation and wheel_radius, however it is nested. Values
/// that are there become the given ones; multipliers that are not there are added below wheel_radius, those
/// of 1 too: a section with wildcards may hold others. Nothing to change: no edits.
/// @param values names and values, m and ratios
/// @param where the file, for errors
/// Errors: format, with the lines, where there is not one such place, or one of its values is no plain
/// number: an expression, a reference, a text, or what another place refers to; and where another section
/// may give the same controller another of these values, or ROS 1's wheel_radius_multiplier is not 1.
Result<std::vector<TextEdit>> diff_drive_edits(const std::string& yaml,
                                               const std::vector<std::pair<std::string, double>>& values,
                                               const std::string& where);

}  // namespace odomcalib::cli
