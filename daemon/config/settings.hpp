// Numbers that decide what a configuration may say, each once, with its unit and its origin: derived (from
// what), or chosen (for what reason). Speeds and accelerations have their upper bounds in
// daemon/routines/settings.hpp.
#pragma once

#include <cstddef>
#include <numbers>

#include "calib/ingest/settings.hpp"

namespace odomcalib::config::settings {

struct Bounds {
  double least, most;
  const char* unit = "";  ///< "m", "rad"; empty: of what has other units, or none
};

/// m, of a wheel or a track. Chosen: toys to mining trucks; what lies outside is another unit.
inline constexpr Bounds kLength_m{1e-3, 10.0, "m"};
/// Counts of a wheel turn. Chosen: any gear and any encoder.
inline constexpr Bounds kTicks{1e-3, 1e9};
/// m, from the middle of the axle to the front and the back of the robot, and its width. Chosen.
inline constexpr Bounds kReach_m{0.01, 5.0, "m"}, kWidth_m{0.02, 5.0, "m"};
/// m, of x and of y, and rad, of the yaw of the lidar in the base. Derived: what a recording may state; and a
/// turn to either side.
inline constexpr Bounds kLidarPlace_m{-calib::ingest::settings::kFarthestLidar_m,
                                      calib::ingest::settings::kFarthestLidar_m, "m"},
    kLidarYaw_rad{-2.0 * std::numbers::pi, 2.0 * std::numbers::pi, "rad"};
/// The slowest limits: m/s, rad/s, m/s^2, rad/s^2. Chosen: below them a motion does not end in its time.
inline constexpr double kLeastSpeed_m_s = 0.02, kLeastRate_rad_s = 0.05, kLeastBraking_m_s2 = 0.05,
                        kLeastTurning_rad_s2 = 0.1;
/// m, of the free area, and of the clearance around the robot. Chosen: a robot of 0.3 m turns on the spot in
/// the smallest one.
inline constexpr Bounds kArea_m{0.6, 20.0, "m"}, kClearance_m{0.05, 2.0, "m"};
/// s of the countdown that a file may ask for, and that there is at least. Rule M16: whoever stands beside
/// the robot gets a moment, whatever the file says.
inline constexpr Bounds kCountdown_s{0.0, 60.0};
inline constexpr double kShortestCountdown_s = 1.0;
/// MB of recordings that are kept. Chosen: one recording; a terabyte.
inline constexpr Bounds kRecordings_MB{1.0, 1e6};

}  // namespace odomcalib::config::settings
