#include "daemon/cli/display.hpp"

#include <fmt/format.h>

#include <cmath>

#include "proto/angles.hpp"

namespace odomcalib::cli {

Display display_of(const std::string& unit) {
  if (unit == "m") return {1000.0, "mm", 3};
  if (unit == "rad") return {kDegrees, "deg", 3};
  if (unit == "s") return {1000.0, "ms", 3};
  if (unit == "m/m") return {1000.0, "mm/m", 3};
  if (unit == "m/rad") return {1000.0 / kDegrees, "mm/deg", 3};
  if (unit == "rad/m") return {kDegrees, "deg/m", 3};
  if (unit == "rad/rad") return {100.0, "%", 3};
  if (unit == "1") return {1.0, "", 6};
  return {1.0, unit, 6};
}

std::string number(double value, int digits) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "-";
}

std::string significant(double value) { return std::isfinite(value) ? fmt::format("{:.3g}", value) : "-"; }

std::string shown(const std::optional<double>& value, const std::string& unit) {
  const Display show = display_of(unit);
  return value ? number(*value * show.factor, show.digits) : "-";
}

std::string readable(std::string name) {
  for (char& c : name)
    if (c == '_') c = ' ';
  return name;
}

}  // namespace odomcalib::cli
