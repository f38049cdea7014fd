// Properties of every recording parser, whatever the bytes: sorted streams, finite numbers, and a result that
// survives writing and reading.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "proto/recording/recording.hpp"
#include "tests/fuzz/share.hpp"

namespace odomcalib::fuzz {

template <typename Sample>
void check_times(const std::vector<Sample>& samples) {
  for (const auto& sample : samples) require(std::isfinite(sample.t));
  require(
      std::is_sorted(samples.begin(), samples.end(), [](const auto& a, const auto& b) { return a.t < b.t; }));
}

inline void check(const Recording& recording) {
  check_times(recording.ticks);
  check_times(recording.scans);
  check_times(recording.poses);
  check_times(recording.gyro);
  check_times(recording.wheels);
  check_times(recording.wheel_speeds);
  check_times(recording.odometry);
  for (const auto& scan : recording.scans) {
    require(scan.angles.empty() || scan.angles.size() == scan.ranges.size());
    require(scan.times.empty() || scan.times.size() == scan.ranges.size());
    require(std::all_of(scan.ranges.begin(), scan.ranges.end(),
                        [](float r) { return std::isfinite(r) && r >= 0.0F; }));
    require(!scan.ranges.empty() && std::isfinite(scan.angle(scan.ranges.size() - 1)));
  }
  for (std::size_t i = 1; i < recording.ticks.size(); ++i)
    require(recording.ticks[i].segment >= recording.ticks[i - 1].segment);
}

/// @param prefix recognised begin of the form, so that the fuzzer does not have to invent it
inline void read_and_check(const std::string& prefix, const std::uint8_t* data, std::size_t size) {
  const RobotDescription robot{0.1, 0.1, 0.3, 1000.0, std::nullopt, "", ""};
  const auto result =
      read_recording_bytes(prefix + std::string(reinterpret_cast<const char*>(data), size), "fuzz", &robot);
  if (result.ok()) check(result.value());
}

/// A ROS recording, also with topics that somebody chooses: those of the seeds, and some that are not there.
inline void read_topics_and_check(const std::string& prefix, const std::uint8_t* data, std::size_t size) {
  read_and_check(prefix, data, size);
  if (!thorough(data, size)) return;
  using Choices = TopicChoices;
  static const std::array kChoices = {Choices{{"wheels", "/joints", {}}},
                                      Choices{{"wheels", "/joints", {"left", "right"}}},
                                      Choices{{"wheels", "/joints", {"left", "middle"}}},
                                      Choices{{"wheel_speeds", "/joints", {}}, {"pose", "/pose", {}}},
                                      Choices{{"odometry", "/odometry", {}}, {"gyro", "/imu", {}}},
                                      Choices{{"pose", "/odometry", {}}},
                                      Choices{{"scan", "/imu", {}}},
                                      Choices{{"scan", "/nowhere", {}}},
                                      Choices{{"scan", "/scan", {}}, {"scan", "/scan", {}}},
                                      Choices{{"wheels", "/joints", {}}, {"wheel_speeds", "/joints", {}}},
                                      Choices{{"fan", "/scan", {}}}};
  const RobotDescription robot{0.1, 0.1, 0.3, 1000.0, std::nullopt, "", ""};
  const std::string bytes = prefix + std::string(reinterpret_cast<const char*>(data), size);
  for (const Choices& choices : kChoices) {
    const auto result = read_recording_bytes(bytes, "fuzz", &robot, choices);
    if (result.ok()) check(result.value());
  }
}

}  // namespace odomcalib::fuzz
