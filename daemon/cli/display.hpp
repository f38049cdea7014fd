// Numbers for people: lengths in mm, angles in degrees, names without underscores.
#pragma once

#include <optional>
#include <string>

namespace odomcalib::cli {

struct Display {
  double factor;
  std::string unit;
  int digits;
};

/// How a quantity of an SI unit is shown.
Display display_of(const std::string& unit);

/// "-" for what is not finite.
std::string number(double value, int digits);

/// Three significant digits; "-" for what is not finite.
std::string significant(double value);

/// Value in the shown unit, without it; "-" when absent.
std::string shown(const std::optional<double>& value, const std::string& unit);

/// "left_wheel_diameter" -> "left wheel diameter".
std::string readable(std::string name);

}  // namespace odomcalib::cli
