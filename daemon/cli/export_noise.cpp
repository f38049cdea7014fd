#include "daemon/cli/export_noise.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/odometry/correction.hpp"
#include "calib/odometry/uncertainty.hpp"
#include "daemon/cli/settings.hpp"

namespace odomcalib::cli {
namespace {

/// Variances: by chance, of a metre rolled; and by what is not known of the lengths, of a metre and a radian,
/// squared.
struct MotionNoise {
  double along, sideways, yaw;  ///< m^2/m, m^2/m, rad^2/m
  double length, bend, turn;    ///< 1, rad^2/m^2, 1
  double track_width;           ///< m
};

/// To first order: the mean of both wheels and their difference, as the covariance of the parameters has
/// them.
MotionNoise motion_noise(const Calibration& calibration, const calib::odometry::IncrementNoise& contact) {
  const auto correction = calib::odometry::correction_of(calibration, false);
  const auto base = calib::vehicle::to_base(calib::vehicle::as_span(correction.parameters));
  const Eigen::Matrix3d covariance = correction.covariance.topLeftCorner<3, 3>();
  const double left = base.left_radius, right = base.right_radius, track = base.track_width;
  const Eigen::Vector3d of_length(0.5 / left, 0.5 / right, 0.0),
      of_bend(-1.0 / (left * track), 1.0 / (right * track), 0.0),
      of_turn(0.5 / left, 0.5 / right, -1.0 / track);
  const auto variance = [&](const Eigen::Vector3d& by) { return by.dot(covariance * by); };
  return {contact[0] * contact[0],
          contact[1] * contact[1],
          contact[2] * contact[2],
          variance(of_length),
          variance(of_bend),
          variance(of_turn),
          track};
}

Result<MotionNoise> noise_of(const Calibration& calibration, const std::string& where) {
  const auto contact = calib::odometry::contact_noise_of(calibration);
  if (contact) return motion_noise(calibration, *contact);
  return Error{ErrorCode::format, "the calibration states no noise of wheels and floor (\"contact_noise\")",
               where, "solve a recording of a minute or more with this program"};
}

/// Variance that a pose has before each match, once matches and steps have gone on for a while (Kalman's
/// equation of a random walk, steady state).
/// @param step variance that a step adds
/// @param match variance of a match
double variance_before_match(double step, double match) {
  return 0.5 * step + std::sqrt(0.25 * step * step + step * match);
}

/// The deviation in slam_toolbox's penalty 1 - gain (distance / deviation)^2: that of a Gaussian near its
/// top. It multiplies the response, which falls by the smear of the grid and not by the deviation of a match:
/// so much wider is the penalty.
double deviation_of_penalty(double step, double match, double smear) {
  return std::sqrt(2.0 * settings::kSlamGain * variance_before_match(step, match) / match) * smear;
}

}  // namespace

Result<std::string> amcl_yaml(const Calibration& calibration, const std::string& where) {
  const auto found = noise_of(calibration, where);
  if (!found) return found.error();
  const MotionNoise& noise = found.value();
  constexpr double kStep = settings::kAmclStep_m, kTurn = settings::kAmclTurn_rad;
  // A turn of an angle rolls half a track width for each radian.
  const double rolled = 0.5 * noise.track_width * kTurn;
  const double alpha1 = noise.yaw * rolled / (kTurn * kTurn) + noise.turn;
  const double alpha2 = 0.5 * (noise.yaw / kStep + noise.bend);
  const double alpha3 = noise.along / kStep + noise.length;
  const double alpha4 = noise.along * rolled / (kTurn * kTurn);
  return fmt::format(
      "# the alphas hold for these steps: they change with them\n"
      "amcl:\n  ros__parameters:\n    robot_model_type: \"nav2_amcl::DifferentialMotionModel\"\n"
      "    update_min_d: {}\n    update_min_a: {}\n    alpha1: {:.4g}\n    alpha2: {:.4g}\n    alpha3: "
      "{:.4g}\n"
      "    alpha4: {:.4g}\n",
      kStep, kTurn, alpha1, alpha2, alpha3, alpha4);
}

Result<std::string> robot_localization_yaml(const Calibration& calibration, const std::string& where) {
  const auto found = noise_of(calibration, where);
  if (!found) return found.error();
  const MotionNoise& noise = found.value();
  constexpr double kSpeed = settings::kSpeedOfNoise, kRate = settings::kRateOfNoise;
  // A message's addition to the way has the variance of the way between two messages; as a speed it is
  // divided by the time between them, squared.
  const double by_chance = kSpeed * kRate;
  constexpr double kUnknown = 1e6;
  return fmt::format(
      "# at {} m/s of the rims and {} messages a second: variances grow with both; libodomcalib states those "
      "of "
      "each message\n"
      "# robot_localization: fuse the velocities (odom0_config x, y and yaw of the twist); the pose's error "
      "grows "
      "with the way\n"
      "diff_drive_controller:\n  ros__parameters:\n"
      "    twist_covariance_diagonal: [{:.4g}, {:.4g}, {:.4g}, {:.4g}, {:.4g}, {:.4g}]\n",
      kSpeed, kRate, noise.along * by_chance + noise.length * kSpeed * kSpeed, noise.sideways * by_chance,
      kUnknown, kUnknown, kUnknown, noise.yaw * by_chance + noise.bend * kSpeed * kSpeed);
}

Result<std::string> slam_toolbox_yaml(const Calibration& calibration, const std::string& where) {
  const auto found = noise_of(calibration, where);
  if (!found) return found.error();
  const MotionNoise& n = found.value();
  constexpr double kStep = settings::kSlamStep_m, kTurn = settings::kSlamTurn_rad,
                   kGrid = settings::kSlamGrid_m, kSmear = settings::kSlamSmear_m,
                   kFine = settings::kSlamFine_rad;
  // A step is a way or a turn, and one number serves both. On the way an error of the heading moves it aside.
  const double rolled = 0.5 * n.track_width * kTurn, squared = kStep * kStep;
  const double along = n.along * kStep + n.length * squared;
  const double aside = n.sideways * kStep + squared * (n.yaw * kStep / 3.0 + n.bend * squared / 4.0);
  const double place = std::max(0.5 * (along + aside), 0.5 * (n.along + n.sideways) * rolled);
  const double heading = std::max(n.yaw * kStep + n.bend * squared, n.yaw * rolled + n.turn * kTurn * kTurn);
  // A match is as good as the grid at best, and so is what it is matched with.
  const double match = kGrid * kGrid / 6.0, match_heading = kFine * kFine / 6.0;
  return fmt::format(
      "# the penalties hold for these steps and this grid: they change with them\n"
      "slam_toolbox:\n  ros__parameters:\n    minimum_travel_distance: {}\n    minimum_travel_heading: {}\n"
      "    correlation_search_space_resolution: {}\n    correlation_search_space_smear_deviation: {}\n"
      "    fine_search_angle_offset: {}\n    distance_variance_penalty: {:.4g}\n"
      "    angle_variance_penalty: {:.4g}\n",
      kStep, kTurn, kGrid, kSmear, kFine, deviation_of_penalty(place, match, kSmear),
      deviation_of_penalty(heading, match_heading, kSmear / settings::kSlamRange_m));
}

}  // namespace odomcalib::cli
