// The motion that a drive lacks, for advice that does not ask for what was driven.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "calib/wheels/wheel_motion.hpp"

namespace odomcalib::calib::classical {

/// The motion to record: the lines or the turns that are hardly there, or both where the wheels always turned
/// in the same proportion. Nothing where no motion is missing.
std::optional<std::string> missing_motion(std::span<const wheels::WheelMotion> motions);

/// The remedy of an estimate that the motion does not determine: to record what is missing, or more of each.
std::string record_more(std::span<const wheels::WheelMotion> motions);

}  // namespace odomcalib::calib::classical
