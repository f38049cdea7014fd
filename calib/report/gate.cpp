#include "calib/report/gate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <optional>
#include <sstream>

#include "calib/classical/sign_check.hpp"
#include "calib/selection/drive_error.hpp"

namespace odomcalib::calib::report {
namespace {

constexpr double kMaxRelativeDeviation = 0.03;  ///< of a diameter or the track width; worse is no calibration
constexpr double kWarnRelativeDeviation = 0.005;
constexpr double kPlausibleLow = 0.5;  ///< estimate over nominal
constexpr double kPlausibleHigh = 2.0;
constexpr double kWarnChange = 0.10;
constexpr double kFewestMatched = 0.1;  ///< of the pairs of scans; the others may say something else
constexpr double kWarnMatched = 0.5;
constexpr double kWarnResidual = 2.0;  ///< times the noise: most of the error over a pair has another cause

std::string percent(double share) {
  std::ostringstream out;
  out << std::setprecision(3) << 100.0 * share << " %";
  return out.str();
}

std::string degrees(double angle) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(0) << angle * 180.0 / math::kPi << " degrees";
  return out.str();
}

std::string times(double ratio) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(1) << ratio << " times";
  return out.str();
}

double nominal_value(const RobotDescription& robot, const std::string& name) {
  if (name == "left_wheel_diameter") return robot.left_wheel_diameter;
  if (name == "right_wheel_diameter") return robot.right_wheel_diameter;
  return robot.track_width;
}

std::string motion_for(const std::string& name) {
  if (name == "track_width") return "turn on the spot, both ways";
  return "drive straight lines, forward and backward, and turn on the spot";
}

double relative_deviation(const Quantity& quantity) { return quantity.std / std::abs(quantity.value); }

std::optional<double> relative_deviation(const QuantityList& quantities, const std::string& name) {
  for (const auto& [own, quantity] : quantities)
    if (own == name) return relative_deviation(quantity);
  return std::nullopt;
}

/// The error over ten seconds where it is more than noise explains; null otherwise.
const DriveError* excessive(const std::vector<DriveError>& errors) {
  const DriveError* error = selection::open_loop_position(errors);
  if (error == nullptr || !error->after || !error->noise_floor) return nullptr;
  const double floor = *error->noise_floor;
  return error->after->value > kWarnResidual * floor && error->after->low > floor ? error : nullptr;
}

class Judgement {
 public:
  void refuse(const std::string& reason) { refusals_.push_back(reason); }
  void warn(const std::string& reason) { warnings_.push_back(reason); }

  /// Of a length that the motion does not determine its value says nothing.
  /// @param measured relative deviation that the motion leaves
  void check(const std::string& name, const Quantity& quantity, double nominal, double measured) {
    if (!(quantity.std >= 0.0) || measured > kMaxRelativeDeviation) {
      const std::string how =
          measured < 1.0 ? "is determined to " + percent(measured) + " only" : "is not determined";
      refuse(name + " " + how + "; to fix that, " + motion_for(name));
      return;
    }
    if (!std::isfinite(quantity.value) || quantity.value <= 0.0) {
      refuse(name +
             " came out as a non-positive length: left and right wheels may be swapped, or the lidar's "
             "direction of "
             "rotation is wrong");
      return;
    }
    const double relative = relative_deviation(quantity);
    if (measured > kWarnRelativeDeviation)
      warn(name + " is determined to " + percent(measured) + " only; a longer recording would help");
    else if (relative > kWarnRelativeDeviation)
      warn(name + " without what was found is known to " + percent(relative) +
           " only: how that goes on where it was not seen, this recording does not tell");
    if (nominal > 0.0) check_against_nominal(name, quantity.value / nominal);
  }

  /// Both may be right: what is called front decides.
  void check_lidar_yaw(double yaw, double nominal) {
    const double apart = math::wrap_angle(yaw - nominal);
    if (std::abs(apart) > classical::kFarYaw)
      warn("lidar_yaw differs from its nominal value by " + degrees(apart) +
           ": correct lidar_pose, or check which end of the robot counts forward");
  }

  void check_matches(std::size_t matched, std::size_t unmatched) {
    const auto all = static_cast<double>(matched + unmatched);
    const std::string finding =
        "only " + std::to_string(matched) + " of " + std::to_string(matched + unmatched) +
        " pairs of scans could be matched; drive where the lidar sees walls on all sides";
    if (static_cast<double>(matched) < kFewestMatched * all)
      refuse(finding);
    else if (static_cast<double>(matched) < kWarnMatched * all)
      warn(finding);
  }

  void check_residual(const ResidualReport& residual) {
    if (!residual.after || !residual.noise_floor) return;
    constexpr std::array kComponents = {"in x of the sensor", "in y of the sensor", "in yaw"};
    for (std::size_t i = 0; i < kComponents.size(); ++i) {
      const double ratio = (*residual.after)[i] / (*residual.noise_floor)[i];
      if (ratio > kWarnResidual)
        warn("the residual " + std::string(kComponents[i]) + " is " + times(ratio) +
             " the noise floor: something was not found, and the stated deviations may be too small");
    }
  }

  /// What loses counts or slips now and then leaves most pairs clean, and adds up on the way.
  void check_drives(const std::vector<DriveError>& errors) {
    if (const DriveError* error = excessive(errors))
      warn("odometry over ten seconds is off by " + times(error->after->value / *error->noise_floor) +
           " the noise floor: something moves the robot that the counts do not show; look for counts that "
           "get lost, slip, and what touches the robot");
  }

  [[nodiscard]] GateResult result() const {
    if (!refusals_.empty()) return {Verdict::refused, refusals_};
    if (!warnings_.empty()) return {Verdict::accepted_with_warnings, warnings_};
    return {Verdict::accepted, {}};
  }

 private:
  void check_against_nominal(const std::string& name, double ratio) {
    if (ratio < kPlausibleLow || ratio > kPlausibleHigh)
      refuse(name + " is " + percent(ratio) +
             " of its nominal value: check ticks per revolution, gear ratio and units");
    else if (std::abs(ratio - 1.0) > kWarnChange)
      warn(name + " differs from its nominal value by " + percent(ratio - 1.0));
  }

  std::vector<std::string> refusals_;
  std::vector<std::string> warnings_;
};

}  // namespace

bool odometry_is_off(const std::vector<DriveError>& errors) { return excessive(errors) != nullptr; }

GateResult judge(const Calibration& calibration, const Footing& footing) {
  Judgement judgement;
  for (const auto& [name, quantity] : calibration.parameters) {
    if (name == "lidar_yaw" && calibration.robot.lidar_pose)
      judgement.check_lidar_yaw(quantity.value, (*calibration.robot.lidar_pose)[2]);
    if (name.starts_with("lidar_")) continue;
    judgement.check(name, quantity, nominal_value(calibration.robot, name),
                    relative_deviation(footing.measured, name).value_or(relative_deviation(quantity)));
  }
  judgement.check_matches(footing.matched, footing.unmatched);
  judgement.check_residual(calibration.residual);
  judgement.check_drives(footing.drive_errors);
  for (const std::string& remark : footing.remarks) judgement.warn(remark);
  if (!footing.converged) judgement.warn("the fit had not settled when its iterations ran out");
  return judgement.result();
}

}  // namespace odomcalib::calib::report
