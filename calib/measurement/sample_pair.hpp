// One motion of the base, by its wheels and by the reference, over the same time and in the same frame.
#pragma once

#include <array>
#include <cstddef>

namespace odomcalib::calib::measurement {

struct SamplePair {
  std::size_t recording = 0;      ///< in the order of the recordings solved
  double begin = 0.0, end = 0.0;  ///< s, on the clock of the sensor
  std::array<double, 3>
      odometry{};  ///< with nominal wheels: m, m, rad, in the frame of the base at the begin
  std::array<double, 3> reference{};  ///< the same by scans or poses
};

}  // namespace odomcalib::calib::measurement
