// Effects of the reference: they change what the lidar says about the motion, not how the wheels move the
// robot.
#pragma once

#include <string>

#include "calib/vehicle/effect.hpp"

namespace odomcalib::calib::terms {

/// Times of the sensor, or motion distortion of its sweeps. Odometry is right without them: a comparison with
/// the reference needs them, dead reckoning must not have them.
inline bool concerns_reference(const vehicle::Effect& effect) {
  return effect.storage() == vehicle::Storage::driver || effect.name() == "scan_skew";
}

/// But for one: encoders that smooth do so whoever looks at them. Only that they are late is a matter of
/// stamps.
inline bool concerns_wheels_too(const vehicle::Effect& effect, const std::string& parameter) {
  return effect.name() == "time_offset" && parameter == "smoothing";
}

}  // namespace odomcalib::calib::terms
