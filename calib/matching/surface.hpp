// A scan as points with local lines: what point-to-line matching needs.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "calib/math/se2.hpp"
#include "proto/measurements.hpp"

namespace odomcalib::calib::matching {

/// One beam end in the sensor frame at the scan's reference time, with a line fitted to its neighbourhood.
struct SurfacePoint {
  Eigen::Vector2d position;
  Eigen::Vector2d beam;    ///< unit vector along which the range was measured
  Eigen::Vector2d anchor;  ///< point of the local line next to `position`
  Eigen::Vector2d normal;  ///< unit normal of the local line, towards the sensor
  double range = 0.0;
  double bearing = 0.0;   ///< rad, as the sensor stated it, before de-skewing
  bool has_line = false;  ///< and lies within the surface's far limit
};

struct Surface {
  std::vector<SurfacePoint> points;  ///< in beam order
  /// m; of walls farther away only the readings come through that noise has shortened.
  double far_limit = std::numeric_limits<double>::infinity();
};

/// Short of the range at which the sensor gives up by so much that no noise gets there, m; infinite where
/// nobody states that range.
double far_limit(double range_max, double range_noise);

/// Motion of the sensor from the scan's reference time to the time of a beam, s after Scan::t.
using BeamMotion = std::function<math::Pose(double seconds_after_first_beam)>;

/// Time of a beam after Scan::t in s; 0 when the recording has none.
double beam_time(const Scan& scan, std::size_t beam);

/// Middle of the sweep after Scan::t in s: the scan's reference time; 0 when beam times are unknown.
double reference_time(const Scan& scan);

/// Whether a beam returned a range within the scan's limits.
bool is_usable(const Scan& scan, std::size_t beam);

/// De-skewed points with local lines. Beams without reading or outside the scan's range limits are left out.
/// @param range_noise standard deviation of a range, m; decides what still counts as one line
Surface make_surface(const Scan& scan, const BeamMotion& motion, double range_noise);

/// How far two readings of one surface may lie apart for their noise alone, m: three deviations of their
/// difference.
[[nodiscard]] inline double gap_by_noise(double range_noise) { return 4.2 * range_noise; }

/// Standard deviation of the range readings, m, from how straight walls look over two and a half degrees. The
/// normal part of what is seen counts, so that corners do not, however few and noisy the readings are.
double estimate_range_noise(std::span<const Scan> scans);

}  // namespace odomcalib::calib::matching
