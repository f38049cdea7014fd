// Effects of the reference: they change what the lidar says about the motion, not how the wheels move the
// robot.
#pragma once

#include "calib/vehicle/effect.hpp"

namespace odomcalib::calib::terms {

/// Times of the sensor, or motion distortion of its sweeps. Odometry is right without them: a comparison with
/// the reference needs them, dead reckoning must not have them.
inline bool concerns_reference(const vehicle::Effect& effect) {
  return effect.storage() == vehicle::Storage::driver || effect.bends_scans();
}

}  // namespace odomcalib::calib::terms
