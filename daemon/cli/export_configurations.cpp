#include "daemon/cli/export_configurations.hpp"

#include <fmt/format.h>

#include <iterator>

#include "daemon/cli/usable_calibration.hpp"

namespace odomcalib::cli {
namespace {

/// As `--robot` reads it.
std::string robot_toml(const Calibration& calibration, const Dimensions& d) {
  std::string out = fmt::format("left_wheel_diameter = {}\nright_wheel_diameter = {}\ntrack_width = {}\n",
                                d.left, d.right, d.track);
  if (calibration.robot.ticks_per_rev > 0.0)
    fmt::format_to(std::back_inserter(out), "ticks_per_rev = {:.1f}\n", calibration.robot.ticks_per_rev);
  const auto x = calibration.parameter("lidar_x");
  const auto y = calibration.parameter("lidar_y");
  const auto yaw = calibration.parameter("lidar_yaw");
  if (x && y && yaw) fmt::format_to(std::back_inserter(out), "lidar_pose = [{}, {}, {}]\n", *x, *y, *yaw);
  return out;
}

/// One radius and a factor for each wheel; effects that only a host can compensate are not in these
/// parameters.
std::string diff_drive_yaml(const Dimensions& d) {
  return fmt::format(
      "diff_drive_controller:\n  ros__parameters:\n    wheel_separation: {}\n    wheel_radius: {}\n"
      "    wheel_separation_multiplier: 1.0\n    left_wheel_radius_multiplier: {}\n"
      "    right_wheel_radius_multiplier: {}\n",
      d.track, 0.5 * d.mean(), d.left / d.mean(), d.right / d.mean());
}

}  // namespace

bool is_configuration(const std::string& what) { return what == "toml" || what == "diff_drive"; }

Result<std::string> configuration(const Calibration& calibration, const std::string& what,
                                  const std::string& where) {
  // A robot would be driven by these.
  if (calibration.verdict == Verdict::refused) return refusal_of(calibration, where);
  const auto dimensions = dimensions_of(calibration, where);
  if (!dimensions) return dimensions.error();
  if (what == "toml") return robot_toml(calibration, dimensions.value());
  if (what == "diff_drive") return diff_drive_yaml(dimensions.value());
  return Error{ErrorCode::usage, "unknown export \"" + what + "\"", "--what",
               "see odomcalibctl export --help"};
}

}  // namespace odomcalib::cli
