// Calibration parameters from the path of the sensor as a whole: every scan has its own placing error, the
// wheels carry the robot from scan to scan with an error that grows with the distance rolled, and both are
// weighed against each other over the whole drive. Equivalent to smoothing the path and fitting the
// parameters at once; the block-tridiagonal covariance of neighbouring motions is factored in O(n).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "calib/estimation/settings.hpp"
#include "calib/measurement/scan_path.hpp"
#include "calib/vehicle/drive_model.hpp"
#include "proto/result.hpp"

namespace odomcalib::calib::estimation {

/// Noise that disturbs one recording.
struct PathNoise {
  double place = 1.0;                                  ///< true over stated deviation of a scan's place
  double forward = settings::kStartPathNoise_m;        ///< m per square root of a metre rolled
  double sideways = settings::kStartPathNoise_m;       ///< same
  double yaw = settings::kStartPathNoise_rad;          ///< rad per square root of a metre rolled
  double stamp_jitter = settings::kLeastPathJitter_s;  ///< s
};

/// One recording.
struct PathData {
  const vehicle::DriveModel* model = nullptr;
  std::vector<measurement::PlacedScan> scans;
};

struct PathFitOptions {
  std::vector<bool> fixed;            ///< parameters that keep their value
  Eigen::MatrixXd prior_information;  ///< of the parameters, about zero
};

struct PathFit {
  Eigen::VectorXd parameters;
  Eigen::MatrixXd covariance;  ///< zero rows for fixed parameters
  std::vector<PathNoise> noise;
  std::size_t used = 0, discarded = 0;  ///< motions from scan to scan
};

/// Errors: empty (too few scans), refused (the motion does not determine the parameters).
Result<PathFit> fit_path(std::span<const PathData> data, const vehicle::EffectList& effects,
                         const Eigen::VectorXd& start, const PathFitOptions& options);

}  // namespace odomcalib::calib::estimation
