// The straight-metre and full-turn methods: compare what the wheels claim with what the sensor saw, one
// quantity at a time.
#pragma once

#include <span>

#include "calib/wheels/wheel_motion.hpp"
#include "proto/result.hpp"

namespace odomcalib::calib::classical {

struct Ratio {
  double value = 1.0;  ///< true over claimed
  double std = 0.0;
  double rms = 0.0;  ///< of the single comparisons: m (straight) or rad (spin)
  std::size_t used = 0;
  std::size_t discarded = 0;
};

/// Distance ratio over the straight parts; assumes equal wheels (one factor for both diameters). The sensor's
/// mounting does not matter: without rotation every point of the robot travels the same distance. Errors:
/// refused when less than 0.3 m was driven straight.
Result<Ratio> straight_ratio(std::span<const wheels::WheelMotion> samples,
                             const wheels::BaseParameters& nominal);

/// Ratio of the claimed to the true rotation over the turns on the spot: track_new = track_old * ratio.
/// @param base with the diameters already corrected: the track width inherits their error
/// Errors: refused when less than a quarter turn was made on the spot.
Result<Ratio> spin_ratio(std::span<const wheels::WheelMotion> samples, const wheels::BaseParameters& base);

}  // namespace odomcalib::calib::classical
