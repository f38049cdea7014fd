// Numbers by which a value of a calibration file is none of a robot, each once, with its unit and its origin.
#pragma once

namespace odomcalib::calibration_file::settings {

/// m and rad beyond which no dimension of a robot is one. Chosen.
inline constexpr double kMostLength_m = 10.0, kMostAngle_rad = 6.3;

}  // namespace odomcalib::calibration_file::settings
