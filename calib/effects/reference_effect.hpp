// Effects of the reference: they change what the lidar says about the motion, not how the wheels move the
// robot.
#pragma once

#include "calib/model/effect.hpp"

namespace odomcalib::calib {

/// Times of the sensor, or motion distortion of its sweeps. Odometry is right without them: a comparison with
/// the reference needs them, dead reckoning must not have them.
inline bool concerns_reference(const Effect& effect) {
  return effect.storage() == Storage::driver || effect.name() == "scan_skew";
}

}  // namespace odomcalib::calib
