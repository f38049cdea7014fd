#include "daemon/cli/export_configurations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>

#include "calib/odometry/correction.hpp"
#include "daemon/cli/diff_drive_place.hpp"
#include "daemon/cli/export_noise.hpp"
#include "daemon/cli/export_step.hpp"
#include "daemon/cli/lidar_joint_place.hpp"
#include "daemon/cli/usable_calibration.hpp"
#include "odomcalib_version.hpp"
#include "proto/base_quantities.hpp"
#include "proto/calibration/report_data.hpp"
#include "proto/calibration/utc.hpp"

namespace odomcalib::cli {
namespace {

/// x, y, yaw; none where it was not measured, as by poses of the base itself.
std::optional<std::array<double, 3>> lidar_pose(const Calibration& calibration) {
  std::array<double, 3> pose{};
  for (std::size_t k = 0; k < pose.size(); ++k) {
    const auto found =
        std::find_if(calibration.parameters.begin(), calibration.parameters.end(),
                     [&](const auto& one) { return is_name_of(one.first, kLidarPoseQuantities.at(k)); });
    if (found == calibration.parameters.end() || !(found->second.std >= 0.0)) return std::nullopt;
    pose.at(k) = found->second.value;
  }
  return pose;
}

/// As `--robot` reads it.
std::string robot_toml(const Calibration& calibration, const Dimensions& d) {
  std::string out = fmt::format("left_wheel_diameter = {}\nright_wheel_diameter = {}\ntrack_width = {}\n",
                                d.left, d.right, d.track);
  if (const auto counts = counts_a_turn(calibration))
    fmt::format_to(std::back_inserter(out), "ticks_per_rev = {:.1f}\n", *counts);
  if (const auto lidar = lidar_pose(calibration))
    fmt::format_to(std::back_inserter(out), "lidar_pose = [{}]\n", fmt::join(*lidar, ", "));
  return out;
}

/// One radius and a factor for each wheel; effects that only a host can compensate are not in these
/// parameters.
std::vector<std::pair<std::string, double>> diff_drive_parameters(const Dimensions& d) {
  return {{"wheel_separation", d.track},
          {"wheel_radius", 0.5 * d.mean()},
          {"wheel_separation_multiplier", 1.0},
          {"left_wheel_radius_multiplier", d.left / d.mean()},
          {"right_wheel_radius_multiplier", d.right / d.mean()}};
}

std::string diff_drive_yaml(const Dimensions& d) {
  std::string text = "diff_drive_controller:\n  ros__parameters:\n";
  for (const auto& [name, value] : diff_drive_parameters(d))
    text += fmt::format("    {}: {}\n", name, real_text(value));
  return text;
}

Result<LidarPlace> lidar_place(const Calibration& calibration, const std::string& where) {
  const auto lidar = lidar_pose(calibration);
  if (!lidar)
    return Error{ErrorCode::format, "the calibration has no lidar pose that was measured", where,
                 "solve a recording with scans of the lidar"};
  return LidarPlace{(*lidar)[0], (*lidar)[1], (*lidar)[2]};
}

/// The lidar on the robot, REP-103: x forward, y left, z up, m and rad. Its height is not measured.
Result<std::string> urdf(const Calibration& calibration, const std::string& where) {
  const auto place = lidar_place(calibration, where);
  if (!place) return place.error();
  const auto& [x, y, yaw] = place.value();
  return fmt::format(
      "<joint name=\"laser_joint\" type=\"fixed\">\n  <parent link=\"base_link\"/>\n  <child "
      "link=\"laser\"/>\n"
      "  <!-- z is not measured -->\n  <origin xyz=\"{} {} 0\" rpy=\"0 0 {}\"/>\n</joint>\n",
      x, y, yaw);
}

/// Parameters of the node that comes with ros_arduino_bridge (its README, "Base controller parameters"): one
/// diameter for both wheels; what a gear does is in the counts per turn of the wheel already.
std::string ros_arduino_yaml(const Calibration& calibration, const Dimensions& d) {
  std::string out = fmt::format("wheel_diameter: {}\nwheel_track: {}\n", d.mean(), d.track);
  if (const auto counts = counts_a_turn(calibration))
    fmt::format_to(std::back_inserter(out), "encoder_resolution: {:.0f}\ngear_reduction: 1.0\n", *counts);
  return out;
}

/// Factors for the values of the controller, and the term to be added. TicksMM counts per mm
/// of the right wheel, RevCount is proportional to the counts of half a turn, DriftFactor corrects the left
/// wheel in parts of 8192 (MobileRobots, "Pioneer 3 Operations Manual", table of the FLASH parameters).
Result<std::string> arcos(const Calibration& calibration, const Dimensions& d, const std::string& where) {
  const RobotDescription& was = calibration.robot;
  if (!(was.left_wheel_diameter > 0.0 && was.right_wheel_diameter > 0.0 && was.track_width > 0.0))
    return Error{ErrorCode::format, "the calibration has no nominal values to go by", where,
                 "state them in the recording or the robot file, and solve again"};
  constexpr double kDriftParts = 8192.0;
  const double ticks = was.right_wheel_diameter / d.right;
  const double drift = kDriftParts * (d.left / d.right - was.left_wheel_diameter / was.right_wheel_diameter);
  return fmt::format("TicksMM      * {:.6f}\nRevCount     * {:.6f}\nDriftFactor  {} {:.0f}\n", ticks,
                     ticks * d.track / was.track_width, drift < 0.0 ? '-' : '+', std::abs(drift));
}

/// Dead reckoning as source.
Result<std::string> step(const Calibration& calibration, const std::string& what, const std::string& where) {
  if (!(calibration.robot.ticks_per_rev > 0.0))
    return Error{ErrorCode::format, "the calibration has no counts per turn", where,
                 "state ticks_per_rev in the recording or the robot file, and solve again"};
  return what == "python" ? step_in_python(calibration) : step_in_c(calibration);
}

/// How a line of comment begins and ends.
struct Comment {
  const char *begin, *end;
};

Comment comment_of(const std::string& what) {
  if (what == "c_header") return {"/* ", " */"};
  if (what == "urdf") return {"<!-- ", " -->"};
  return what == "arcos" ? Comment{"; ", ""} : Comment{"# ", ""};
}

/// "--" ends no comment of XML too early.
std::string commented(const std::string& what, std::string text) {
  const Comment comment = comment_of(what);
  for (std::size_t at = 0; (at = text.find("--", at)) != std::string::npos;) text.replace(at, 2, "- -");
  for (std::size_t at = 0; (at = text.find("*/", at)) != std::string::npos;) text.replace(at, 2, "* /");
  for (char& c : text)
    if (c == '\n' || c == '\r') c = ' ';
  return comment.begin + text + comment.end + "\n";
}

/// The robot, the recordings, the program, and its verdict on the result.
std::string provenance(const Calibration& calibration, const std::string& what) {
  const std::string robot = calibration.robot.robot_id.empty() ? "" : " of " + calibration.robot.robot_id;
  const std::string solved_by = calibration.settings ? calibration.settings->version : "";
  const auto& driven = calibration.driven;
  std::string text =
      commented(what, "calibration" + robot + (solved_by.empty() ? "" : " by odomcalib " + solved_by) +
                          (driven ? ", driven " + utc_span(driven->begin, driven->end) : "") + ": " +
                          name_of(calibration.verdict) +
                          (solved_by == kVersion ? "" : fmt::format("; exported by odomcalib {}", kVersion)));
  for (const DataUse& data : calibration.data) {
    constexpr std::size_t kDay = 10;  // characters of "2026-05-04"
    const bool dated = data.begin && is_date(*data.begin);
    text +=
        commented(what, "from " + data.name + (dated ? ", " + utc_text(*data.begin).substr(0, kDay) : "") +
                            (data.sha256.empty() ? "" : ", sha256 " + data.sha256));
  }
  if (what == "arcos")
    text +=
        commented(what, "apply these to the values that the controller holds, and round to whole numbers");
  return text;
}

/// "3.4 degrees a turn and 4.2 mm a metre", of the figures that are there; empty: none.
std::string errors_text(const std::vector<DriveError>& errors, std::optional<Bounded> DriveError::*figure) {
  constexpr double kMillimetres = 1e3, kDegrees = 180.0 / std::numbers::pi;
  std::string text;
  for (const DriveError& error : errors) {
    if (!(error.*figure)) continue;
    const double value = (error.*figure)->value;
    if (error.name == "full_turn_heading")
      text += fmt::format("{}{:.2g} degrees a turn", text.empty() ? "" : " and ", kDegrees * value);
    if (error.name == "straight_metre_length")
      text += fmt::format("{}{:.2g} mm a metre", text.empty() ? "" : " and ", kMillimetres * value);
  }
  return text;
}

/// Advice where the calibration does not know the counts of a turn; null: the export has no place for them.
const char* unknown_counts(const std::string& what) {
  if (what == "ros_arduino")
    return "encoder_resolution and gear_reduction are left out: the recording has no counts; they stay what "
           "they are";
  if (what == "c_header" || what == "python")
    return "the recording has no counts: those that this takes are angles of the wheels in parts of a turn, "
           "as "
           "many as it states";
  return nullptr;
}

Result<std::string> configuration_text(const Calibration& calibration, const Dimensions& dimensions,
                                       const std::string& what, const std::string& where) {
  if (what == "toml") return robot_toml(calibration, dimensions);
  if (what == "diff_drive") return diff_drive_yaml(dimensions);
  if (what == "urdf") return urdf(calibration, where);
  if (what == "ros_arduino") return ros_arduino_yaml(calibration, dimensions);
  if (what == "arcos") return arcos(calibration, dimensions, where);
  if (what == "amcl") return amcl_yaml(calibration, where);
  if (what == "robot_localization") return robot_localization_yaml(calibration, where);
  if (what == "slam_toolbox") return slam_toolbox_yaml(calibration, where);
  if (what == "c_header" || what == "python") return step(calibration, what, where);
  return Error{ErrorCode::usage, "unknown export \"" + what + "\"", "--what",
               "see odomcalibctl export --help"};
}

/// Noise is what is left once odometry has its effects.
std::vector<std::string> assumed_of_odometry(const Calibration& calibration) {
  std::vector<std::string> names;
  for (const auto& placement : calib::odometry::effect_placements(calibration))
    if (placement.place == calib::odometry::Place::odometry &&
        std::find(names.begin(), names.end(), placement.effect) == names.end())
      names.push_back(placement.effect);
  for (const std::string& name : calib::odometry::unknown_effects(calibration)) names.push_back(name);
  if (names.empty()) return {};
  std::vector<std::string> sentences{fmt::format(
      "this is the noise of odometry that is corrected for its effects ({}), which are not held here",
      fmt::join(names, ", "))};
  if (std::string lost = lost_without_effects(calibration, false); !lost.empty())
    sentences.push_back(std::move(lost));
  return sentences;
}

}  // namespace

const std::vector<std::string>& configurations() {
  static const std::vector<std::string> names = {
      "toml",     "diff_drive", "urdf", "ros_arduino",        "arcos",
      "c_header", "python",     "amcl", "robot_localization", "slam_toolbox"};
  return names;
}

bool is_configuration(const std::string& what) {
  return std::find(configurations().begin(), configurations().end(), what) != configurations().end();
}

std::string lost_without_effects(const Calibration& calibration, bool is_step) {
  const auto placements = calib::odometry::effect_placements(calibration);
  const bool loses = std::any_of(placements.begin(), placements.end(), [&](const auto& placement) {
    return placement.place == calib::odometry::Place::odometry && !(is_step && is_in_step(placement.effect));
  });
  if (!loses) return "";
  const auto errors = report_data_of(calibration).drive_errors;
  const std::string without = errors_text(errors, &DriveError::geometry),
                    with = errors_text(errors, &DriveError::after);
  const std::string remedy = is_step ? "libodomcalib applies them"
                                     : "libodomcalib applies them, and so do the exports c_header and python";
  if (without.empty() || with.empty()) return "without these effects odometry is worse: " + remedy;
  return "without these effects odometry errs by " + without + ", with them by " + with + ": " + remedy;
}

std::vector<std::string> not_held(const Calibration& calibration, const std::string& what) {
  // How far odometry errs is no odometry.
  if (what == "amcl" || what == "robot_localization" || what == "slam_toolbox")
    return assumed_of_odometry(calibration);
  std::vector<std::string> sentences;
  const bool is_step = what == "c_header" || what == "python";
  for (const auto& placement : calib::odometry::effect_placements(calibration)) {
    using calib::odometry::Place;
    // Effects of the place or the day are nobody's to hold; a lidar's joint has no wheels.
    if (placement.place == Place::nowhere || (what == "urdf" && placement.place == Place::odometry)) continue;
    // Odometry as source has what moves the base, and nothing of the lidar.
    if (is_step && (placement.place == Place::reference || is_in_step(placement.effect))) continue;
    const Quantity& q = placement.quantity;
    const std::string name =
        placement.effect + (placement.parameter.empty() ? "" : "." + placement.parameter);
    const std::string value = placement.parameter.empty() ? "" : fmt::format(" = {:.4g} {}", q.value, q.unit);
    sentences.push_back(fmt::format("not held here: {}{}", name, value));
  }
  for (const std::string& name : calib::odometry::unknown_effects(calibration))
    sentences.push_back("not held here: " + name + ", an effect that this program does not know");
  const auto left = calibration.parameter(BaseQuantity::left_wheel_diameter),
             right = calibration.parameter(BaseQuantity::right_wheel_diameter);
  if (what == "ros_arduino" && left && right && *left != *right)
    sentences.push_back(
        fmt::format("not held here: left and right wheel differ by {:.2f} %, this is their mean",
                    100.0 * (*left / *right - 1.0)));
  if (const char* counts = counts_a_turn(calibration) ? nullptr : unknown_counts(what))
    sentences.emplace_back(counts);
  if (const std::string lost = what == "urdf" ? "" : lost_without_effects(calibration, is_step);
      !lost.empty())
    sentences.push_back(lost);
  return sentences;
}

Result<std::string> configuration(const Calibration& calibration, const std::string& what,
                                  const std::string& where) {
  // A robot would be driven by these.
  if (calibration.verdict == Verdict::refused) return refusal_of(calibration, where);
  const auto dimensions = dimensions_of(calibration, where);
  if (!dimensions) return dimensions.error();
  const auto text = configuration_text(calibration, dimensions.value(), what, where);
  if (!text) return text.error();
  std::string head = provenance(calibration, what);
  for (const std::string& sentence : not_held(calibration, what)) head += commented(what, sentence);
  return head + text.value();
}

bool goes_into_files(const std::string& what) { return what == "diff_drive" || what == "urdf"; }

Result<std::vector<TextEdit>> edits_of(const Calibration& calibration, const std::string& what,
                                       const OwnText& own, const std::string& where) {
  if (calibration.verdict == Verdict::refused) return refusal_of(calibration, where);
  if (what == "urdf") {
    const auto place = lidar_place(calibration, where);
    if (!place) return place.error();
    return lidar_joint_edits(own.text, place.value(), own.link, own.path);
  }
  const auto dimensions = dimensions_of(calibration, where);
  if (!dimensions) return dimensions.error();
  return diff_drive_edits(own.text, diff_drive_parameters(dimensions.value()), own.path);
}

}  // namespace odomcalib::cli
