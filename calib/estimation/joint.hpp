// Weighted robust nonlinear least squares on the sensor's motion: wheel radii, track width, sensor pose and
// effects.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "calib/estimation/settings.hpp"
#include "calib/measurement/sensor_pair.hpp"
#include "calib/measurement/whitening.hpp"
#include "calib/vehicle/drive_model.hpp"
#include "proto/result.hpp"

namespace odomcalib::calib::estimation {

struct FitOptions {
  std::vector<bool> fixed;  ///< parameters kept at their start value; empty: none
  int max_iterations = settings::kMostJointIterations;
  std::vector<measurement::NoiseModel>
      noise;  ///< given (one per recording): used as it is; empty: estimated from the residuals
};

struct FitResult {
  Eigen::VectorXd parameters;
  Eigen::MatrixXd covariance;   ///< zero rows for fixed parameters
  Eigen::MatrixXd residuals;    ///< n x 3, measured - predicted in the sensor's frame: m, m, rad
  std::vector<double> weights;  ///< robust weight per pair
  std::vector<measurement::NoiseModel> noise;  ///< per recording
  Eigen::VectorXd whitened_residual;           ///< 3 n, unit variance if the model is complete
  Eigen::MatrixXd whitened_jacobian;           ///< 3 n x parameters, of the prediction
  Eigen::MatrixXd prior_information;           ///< of priors about zero; already part of the covariance
  Eigen::Vector3d rms;  ///< of the residuals of the pairs that are not outliers: m, m, rad
  double cost = 0.0;    ///< robust -2 log likelihood up to a constant, on `noise`
  std::size_t used = 0;
  std::size_t discarded = 0;  ///< outliers: more than 5 sigma
  std::vector<bool> outlier;  ///< per pair
  bool converged = false;
};

/// Fits from `start`. Robustness: Student t weights (4 degrees of freedom), scale and correlation from the
/// residuals. Covariance: the larger of the model's and of a cluster-robust estimate over blocks of the
/// recording. Errors: empty (no pairs), refused (normal matrix singular; names the parameters that the motion
/// does not determine). Throws std::invalid_argument if `start` has fewer parameters than base and effects.
Result<FitResult> fit_joint(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
                            const Eigen::VectorXd& start, const FitOptions& options = {});

/// The noise that residuals show, found as fit_joint finds it: of each recording, or of short ones together.
/// @param fit says how the sensor moved
/// @param residuals one per pair, measured - predicted in the sensor's frame: m, m, rad
std::vector<measurement::NoiseModel> noise_shown(std::span<const measurement::FitData> data,
                                                 const vehicle::EffectList& effects, const FitResult& fit,
                                                 std::span<const Eigen::Vector3d> residuals);

/// The same fit seen with other weights: whitened residual and Jacobian are made anew, nothing is fitted. Two
/// models can be compared only with the same weights, since each model's own weights spare what it explains
/// badly.
FitResult with_weights(std::span<const measurement::FitData> data, const vehicle::EffectList& effects,
                       FitResult fit, const std::vector<double>& weights);

}  // namespace odomcalib::calib::estimation
