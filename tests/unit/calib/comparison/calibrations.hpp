// Calibrations drawn from the covariance that they state.
#pragma once

#include <Eigen/Cholesky>
#include <random>
#include <string>
#include <vector>

#include "proto/calibration/calibration.hpp"
#include "proto/calibration/scale.hpp"

namespace odomcalib::test_support {

/// m, m, m, m, m, rad.
struct TrueState {
  double left = 0.15, right = 0.1502, track = 0.4, x = 0.1, y = 0.0, yaw = 0.05;
};

/// Deviations as a guided drive of some minutes gives them; diameters are correlated, and so is the track.
inline Eigen::MatrixXd usual_covariance() {
  const Eigen::VectorXd std = (Eigen::VectorXd(6) << 3e-5, 3e-5, 1.5e-4, 4e-4, 4e-4, 1e-3).finished();
  Eigen::MatrixXd correlation = Eigen::MatrixXd::Identity(6, 6);
  correlation(0, 1) = correlation(1, 0) = 0.8;
  correlation(0, 2) = correlation(2, 0) = correlation(1, 2) = correlation(2, 1) = 0.5;
  return std.asDiagonal() * correlation * std.asDiagonal();
}

inline Calibration stated(const Eigen::VectorXd& value, const Eigen::MatrixXd& covariance) {
  Calibration calibration;
  calibration.robot.left_wheel_diameter = calibration.robot.right_wheel_diameter = 0.15;
  calibration.robot.track_width = 0.4;
  calibration.robot.robot_id = "r1";
  calibration.covariance_order = {
      "left_wheel_diameter", "right_wheel_diameter", "track_width", "lidar_x", "lidar_y", "lidar_yaw"};
  for (Eigen::Index k = 0; k < 6; ++k) {
    calibration.parameters.emplace_back(calibration.covariance_order[static_cast<std::size_t>(k)],
                                        Quantity{value(k), std::sqrt(covariance(k, k)), k < 5 ? "m" : "rad"});
    calibration.covariance.emplace_back();
    for (Eigen::Index i = 0; i < 6; ++i) calibration.covariance.back().push_back(covariance(k, i));
  }
  calibration.verdict = Verdict::accepted;
  calibration.reasons = {};
  return calibration;
}

/// One measurement of it.
inline Calibration drawn(const TrueState& robot, std::mt19937& random) {
  const Eigen::MatrixXd covariance = usual_covariance();
  std::normal_distribution<double> normal;
  const Eigen::VectorXd error = Eigen::VectorXd::NullaryExpr(6, [&] { return normal(random); });
  const Eigen::VectorXd truth =
      (Eigen::VectorXd(6) << robot.left, robot.right, robot.track, robot.x, robot.y, robot.yaw).finished();
  return stated(truth + covariance.llt().matrixL() * error, covariance);
}

/// Several of them as they are compared.
inline std::vector<const Calibration*> views(const std::vector<Calibration>& all) {
  std::vector<const Calibration*> out;
  out.reserve(all.size());
  for (const Calibration& one : all) out.push_back(&one);
  return out;
}

}  // namespace odomcalib::test_support
