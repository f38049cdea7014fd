// Contribution of a gyro to a fit, and its fault where it cannot be believed. Its scale, its bias and its
// clock are its own and are found beside the robot's lengths: it shows how the wheels turned the robot where
// the lidar saw too little, and how much of an error is slip.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/estimation/joint.hpp"
#include "proto/recording/recording.hpp"

namespace odomcalib::calib::estimation {

/// The gyro of one recording.
struct GyroFinding {
  std::optional<std::string> fault;  ///< why it was left out, a sentence with what to do
  double scale = 1.0;                ///< what it reads over what the robot turned
  double scale_std = -1.0;
  double bias = 0.0;     ///< rad/s
  double offset = 0.0;   ///< s, its stamps less those of the lidar
  std::size_t used = 0;  ///< intervals in which it was held against wheels and lidar; 0 without a gyro
};

struct GyroFit {
  std::vector<GyroFinding> gyros;  ///< one per recording
  Eigen::VectorXd parameters;      ///< of the fit, and what the gyros add to them
  Eigen::MatrixXd covariance;
};

/// @param fit of these data and effects
/// @param recordings one for each of the data
GyroFit fit_gyros(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
                  const FitResult& fit, std::span<const Recording> recordings);

}  // namespace odomcalib::calib::estimation
