// How large the noise of a recording is: matcher, wheels and time stamps separated by how the residuals
// spread.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "calib/measurement/settings.hpp"
#include "calib/measurement/whitening.hpp"

namespace odomcalib::calib::measurement {

using settings::kStudentConsistency;
using settings::kStudentDof;

/// Maximises the t likelihood of the single pairs over matcher scale, process noise and stamp jitter by
/// coordinate search; then the correlation of neighbours from what the jitter does not explain.
/// @param residuals of the pairs in the sensor's frame, m, m, rad
NoiseModel estimate_noise(std::span<const SensorPair> pairs, std::span<const PairState> states,
                          std::span<const Eigen::Vector3d> residuals, const NoiseModel& start);

/// Squared Mahalanobis distance of each pair's residual under its own covariance.
std::vector<double> squared_distances(std::span<const SensorPair> pairs, std::span<const PairState> states,
                                      std::span<const Eigen::Vector3d> residuals, const NoiseModel& noise);

}  // namespace odomcalib::calib::measurement
