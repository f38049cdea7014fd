// The least error with which any estimator can learn the robot from a run: Fisher information of all range
// readings about the six parameters, with the true room known, the true poses as nuisance parameters, and
// the wheels' slip between them at its true size. Written from the truth alone.
#pragma once

#include <array>

#include "tests/sim/world/simulate.hpp"

namespace odomcalib::sim {

/// Order: left diameter, right diameter, track width, lidar x, lidar y (m), lidar yaw (rad).
inline constexpr std::size_t kLearned = 6;

/// Standard deviations of an efficient estimator (Cramer and Rao). A. Censi, On achievable accuracy for
/// range-finder localization, ICRA 2007, has the information of one scan; a linear recursion over the poses
/// joins the scans.
/// @param run made from `config`, without disturbances
std::array<double, kLearned> ray_bound(const SimulationConfig& config, const SimulatedRun& run);

}  // namespace odomcalib::sim
