// Two scans in, the motion between them out: scan matching for callers outside calibration.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "proto/measurements.hpp"

namespace odomcalib::calib {

/// How the motion is looked for: point to line with a search where that fails; or the best score over a grid
/// of poses, by trying each of them, or by climbing from the guess to the nearest summit.
enum class Matcher { lines, brute, fast };

struct ScanMatch {
  std::string status = "not_converged";  ///< "ok", or why there is no pose: too_few_points, no_overlap,
                                         ///< degenerate, not_converged
  std::array<double, 3> pose{};          ///< of the second scan in the frame of the first: m, m, rad
  std::array<std::array<double, 3>, 3> covariance{};  ///< x, y, yaw: m^2, m rad, rad^2
  std::array<double, 2> weak_direction{};  ///< of a degenerate match: unit vector in the frame of the first
                                           ///< scan, along which the motion is not determined
  std::size_t inliers = 0;
  std::optional<double> score;  ///< of a search, 0 to 1: how near the points of the scan lie to the reference
  [[nodiscard]] bool ok() const { return status == "ok"; }
};

/// Point-to-line match of two scans taken at rest (no de-skewing). When that fails from the guess, or
/// explains the scans poorly, it starts again from the best pose within 1 m and 45 degrees of the guess.
/// @param guess start of the search, m, m, rad
/// @param range_noise standard deviation of a range, m; estimated from the scans when absent
ScanMatch match_scans(const Scan& reference, const Scan& scan, const std::array<double, 3>& guess,
                      std::optional<double> range_noise = std::nullopt);

/// The best pose within 1 m and 45 degrees of the guess by brute force, or the summit next to the guess by
/// hill climbing (fast), without covariance. Status too_few_points or ok: a search always finds something.
ScanMatch search_scans(const Scan& reference, const Scan& scan, const std::array<double, 3>& guess,
                       Matcher matcher);

}  // namespace odomcalib::calib
