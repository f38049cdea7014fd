// Stretches of a recording over which dead reckoning is compared with the reference: ten seconds of whatever
// came, a metre straight, a full turn on the spot.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "calib/estimators/joint.hpp"

namespace odomcalib::calib {

enum class StretchKind { open_loop, straight, turn };

/// Unbroken, well-matched pairs first..last of one recording, inside one fold.
struct Stretch {
  std::size_t recording = 0;
  std::size_t first = 0, last = 0;  ///< pairs of the recording, both included
  std::size_t fold = 0;
  std::size_t block = 0;  ///< of half a minute: stretches of one block are not independent
  double amount = 1.0;    ///< in units of the kind: 1 for open loop, m of length, full turns
  Interval interval;
  Pose motion;                 ///< measured, of the base, in its frame at the begin
  Eigen::Matrix3d covariance;  ///< of `motion` as the noise model has it: reference and wheels
};

/// @param folds of all pairs (see folds_of); @param fit gives mount, noise and which matches to trust
std::vector<Stretch> find_stretches(StretchKind kind, std::span<const FitData> data,
                                    const std::vector<std::size_t>& folds, const FitResult& fit);

}  // namespace odomcalib::calib
