// Evaluation windows of a recording over which dead reckoning is compared with the reference: ten seconds of
// whatever came, a metre straight, a full turn on the spot.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "calib/estimation/joint.hpp"

namespace odomcalib::calib::validation {

enum class WindowKind { open_loop, straight, turn, way };

/// Unbroken, measured pairs first..last of one recording, inside one fold.
struct EvaluationWindow {
  std::size_t recording = 0;
  std::size_t first = 0, last = 0;  ///< pairs of the recording, both included
  std::size_t fold = 0;
  std::size_t block = 0;  ///< of half a minute: windows of one block are not independent
  double amount = 1.0;    ///< in units of the kind: 1 for open loop, m of length or of way, full turns
  vehicle::Interval interval;
  math::Pose chained;          ///< motion of the sensor in its frame at the begin, by the matches
  Eigen::Matrix3d covariance;  ///< of the base's motion as the noise model has it: reference and wheels
};

/// Motion of the sensor over a window by the reference, in its frame at the begin: places in a map, where
/// there are any, or else the chain.
/// @param wheels carry the places to the ends of the window (see mean_place)
math::Pose measured_motion(const EvaluationWindow& window, const measurement::FitData& data,
                           const measurement::PathOfWheels& wheels);

/// One flag per pair: whether its match is to be trusted by a fit. A pair far out on the tail may have
/// failed.
std::vector<bool> trusted_pairs(const estimation::FitResult& fit);
/// By either of two: far out for both, a match has failed.
std::vector<bool> trusted_pairs(const estimation::FitResult& a, const estimation::FitResult& b);

/// Those that are trusted, or of which a map knows where both scans were taken: what the wheels did wrong
/// there is part of odometry's error.
std::vector<bool> measured_pairs(std::span<const measurement::FitData> data, std::vector<bool> trusted);

/// None where all pairs lie in one fold: nothing is left to fit to.
/// @param folds of all pairs (see folds_of)
/// @param fit gives mount and noise
/// @param trusted one flag per pair; windows do not cross a pair that is not. Two models are compared on
///        the same windows, so the flags must not come from one of them alone
std::vector<EvaluationWindow> find_windows(WindowKind kind, std::span<const measurement::FitData> data,
                                           const std::vector<std::size_t>& folds,
                                           const estimation::FitResult& fit,
                                           const std::vector<bool>& trusted);

/// Windows of the kind `way`, over which the robot goes as far as `length`, m, on whatever path.
std::vector<EvaluationWindow> find_windows_of_way(double length, std::span<const measurement::FitData> data,
                                                  const std::vector<std::size_t>& folds,
                                                  const estimation::FitResult& fit,
                                                  const std::vector<bool>& trusted);

}  // namespace odomcalib::calib::validation
