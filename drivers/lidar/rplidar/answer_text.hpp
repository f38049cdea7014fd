// Answers of an RPLIDAR as messages for people.
#pragma once

#include <optional>

#include "drivers/bytes.hpp"
#include "drivers/lidar/lidar.hpp"

namespace odomcalib::drivers::rplidar {

/// Unknown content is shown as hexadecimal digits.
LidarMessage describe_answer(std::uint8_t type, Bytes payload);

/// Time per point, s, when the answer tells it for the mode in use (key 71h).
std::optional<double> reported_sample_time(std::uint8_t type, Bytes payload);

}  // namespace odomcalib::drivers::rplidar
