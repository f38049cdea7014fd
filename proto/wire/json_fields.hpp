// The fields of one recorded JSON object, filled by a SAX handler without building a tree. Internal to
// proto/.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace odomcalib {

/// Scalars that the recording formats know; every other member is skipped.
enum class Scalar : std::uint8_t {
  t,
  left,
  right,
  segment,
  angle_min,
  angle_max,
  angle_increment,
  time_increment,
  range_min,
  range_max,
  x,
  y,
  yaw,
  yaw_rate,
  wheel_diameter,
  left_wheel_diameter,
  right_wheel_diameter,
  track_width,
  ticks_per_rev,
  time_zero,
  beams,
  tuple_duration,
  tuple_left,
  tuple_right,
  count
};

enum class Array : std::uint8_t {
  ranges,
  angles,
  times,
  intensities,
  lidar_pose,
  timestamp,
  left_timestamp,
  right_timestamp,
  tuple_motion,
  valid,
  count
};

enum class Text : std::uint8_t { type, sensor, robot_id, controller, controller_id, count };

struct JsonFields {
  /// NaN: absent, null, or not a number.
  std::array<double, static_cast<std::size_t>(Scalar::count)> scalars{};
  /// `left` and `right` where they are exact integers.
  std::array<std::optional<std::int64_t>, 2> counts;
  /// Elements that are not numbers are NaN; null in ranges and intensities is 0, a truth value in `valid` 0
  /// or 1.
  std::array<std::vector<double>, static_cast<std::size_t>(Array::count)> arrays;
  /// A number is its text.
  std::array<std::string, static_cast<std::size_t>(Text::count)> texts;
  /// Scalars that were written at all, number or not; null is absent.
  std::array<bool, static_cast<std::size_t>(Scalar::count)> present{};
  /// Names of members whose value is of another type than theirs; null is absent, NaN a number.
  std::vector<std::string_view> wrong_types;

  void clear();
  [[nodiscard]] double operator[](Scalar field) const { return scalars.at(static_cast<std::size_t>(field)); }
  [[nodiscard]] bool is_of_wrong_type(std::string_view member) const {
    return std::find(wrong_types.begin(), wrong_types.end(), member) != wrong_types.end();
  }
  [[nodiscard]] bool has(Scalar field) const { return present.at(static_cast<std::size_t>(field)); }
  [[nodiscard]] const std::vector<double>& operator[](Array field) const {
    return arrays.at(static_cast<std::size_t>(field));
  }
  [[nodiscard]] const std::string& operator[](Text field) const {
    return texts.at(static_cast<std::size_t>(field));
  }
};

/// Parses one JSON object into `fields`. False when the text is not exactly one object, is nested deeper than
/// 64 levels, or holds a number that no double can hold.
bool parse_fields(std::string_view text, JsonFields& fields);

}  // namespace odomcalib
