// Measurements on a robot, in SI units and radians (REP-103): the value types that every folder shares.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace odomcalib {

/// Nominal geometry of a differential-drive robot. Diameters and track width are effective values in m.
struct RobotDescription {
  double left_wheel_diameter = 0.0;
  double right_wheel_diameter = 0.0;
  double track_width = 0.0;
  double ticks_per_rev = 0.0;                       ///< counts per wheel turn
  std::optional<std::array<double, 3>> lidar_pose;  ///< x, y [m], yaw [rad] of the lidar in the base frame
  std::string robot_id;
  std::string controller;          ///< profile or kind
  std::string controller_id = {};  ///< vendor/product/serial number of each device; empty: not known
};

/// Cumulative wheel counts at one instant; forward motion counts up on both sides.
struct TickSample {
  double t = 0.0;  ///< s
  std::int64_t left = 0;
  std::int64_t right = 0;
  std::int32_t segment = 0;  ///< increases whenever counts cannot be continued (reset, jump)
};

/// One sweep of a 2D lidar in the sensor's own frame.
struct Scan {
  double t = 0.0;                        ///< s, time of the first beam
  double angle_min = 0.0;                ///< rad, direction of beam 0, counter-clockwise positive
  double angle_increment = 0.0;          ///< rad, negative for a clockwise lidar
  std::optional<double> time_increment;  ///< s between beams; unknown when absent
  double range_min = 0.0;                ///< m
  double range_max = 0.0;                ///< m
  std::vector<float> ranges;             ///< m, 0 = no reading
  std::vector<float> angles;             ///< rad per beam; replaces the uniform grid when not empty
  std::vector<float> times;              ///< s after t per beam; replaces time_increment when not empty
  std::vector<float> intensities;        ///< device units; empty when the device gives none
  std::string sensor;                    ///< name of the sensor, empty for the only one

  [[nodiscard]] double angle(std::size_t beam) const {
    return angles.empty() ? angle_min + angle_increment * static_cast<double>(beam)
                          : static_cast<double>(angles[beam]);
  }
};

/// Pose of the base in a fixed frame, from motion capture or a localiser.
struct PoseSample {
  double t = 0.0;
  double x = 0.0, y = 0.0, yaw = 0.0;
};

/// Both wheels at one instant, as a joint state or a motor controller tells them; positive drives forward.
struct WheelSample {
  double t = 0.0;     ///< s
  double left = 0.0;  ///< rad (cumulative angle) or rad/s (speed, held until the next sample)
  double right = 0.0;
};

struct GyroSample {
  double t = 0.0;
  double yaw_rate = 0.0;  ///< rad/s, counter-clockwise positive
};

/// One interval of a tuple file (Censi et al., T-RO 2013): wheel speeds and the lidar's motion in it.
struct IncrementSample {
  double duration = 0.0;                       ///< s
  double left_speed = 0.0, right_speed = 0.0;  ///< mean wheel speeds, rad/s
  std::array<double, 3> lidar_motion{};        ///< x, y [m], yaw [rad] in the frame of the first scan
};

/// s, in the order of the samples.
template <typename Sample>
std::vector<double> stamps_of(const std::vector<Sample>& samples) {
  std::vector<double> stamps;
  stamps.reserve(samples.size());
  for (const Sample& sample : samples) stamps.push_back(sample.t);
  return stamps;
}

/// @param samples as many as stamps
template <typename Sample>
void set_stamps(std::vector<Sample>& samples, const std::vector<double>& stamps) {
  for (std::size_t k = 0; k < samples.size(); ++k) samples[k].t = stamps[k];
}

}  // namespace odomcalib
