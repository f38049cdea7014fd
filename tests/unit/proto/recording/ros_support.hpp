// Small ROS recordings for the tests in this folder.
#pragma once

#include <cmath>
#include <random>

#include "tests/sim/ros/containers.hpp"
#include "tests/unit/proto/support.hpp"

namespace odomcalib::test {

inline RobotDescription ros_robot() { return {0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""}; }

/// Four seconds: counts that bend, scans with beams without a reading, a gyro.
inline Recording small_drive() {
  Recording drive;
  drive.robot = ros_robot();
  for (int k = 0; k < 200; ++k)
    drive.ticks.push_back({0.02 * k, std::llround(40.0 * k + 5.0 * std::sin(0.1 * k)),
                           std::llround(35.0 * k + 9.0 * std::sin(0.07 * k)), 0});
  for (int k = 0; k < 40; ++k) {
    Scan scan;
    scan.t = 0.003 + 0.1 * k;
    scan.angle_min = -1.5;
    scan.angle_increment = 0.125;
    scan.time_increment = 1.0 / 1024.0;  // exact in single precision
    scan.range_min = 0.125;
    scan.range_max = 8.0;
    for (int beam = 0; beam < 25; ++beam)
      scan.ranges.push_back(beam == 7 ? 0.0F : 1.0F + 0.01F * static_cast<float>(beam + k));
    drive.scans.push_back(std::move(scan));
    drive.gyro.push_back({0.1 * k, 0.01 * k});
  }
  return drive;
}

/// Header stamps as times from the first whole second: to the nanosecond.
constexpr double kNanosecond = 1.01e-9;

/// Expects that a reader found small_drive(), given by joints or by odometry.
inline void expect_small_drive(const Recording& found, MotionSource motion) {
  const Recording drive = small_drive();
  EXPECT_EQ(found.motion, motion);
  ASSERT_EQ(found.ticks.size(), drive.ticks.size()) << list_discarded(found);
  for (std::size_t i = 0; i < drive.ticks.size(); ++i) {
    EXPECT_NEAR(found.ticks[i].t, drive.ticks[i].t, kNanosecond);
    if (motion != MotionSource::wheels) continue;
    EXPECT_EQ(found.ticks[i].left, drive.ticks[i].left);
    EXPECT_EQ(found.ticks[i].right, drive.ticks[i].right);
  }
  ASSERT_EQ(found.scans.size(), drive.scans.size()) << list_discarded(found);
  for (std::size_t i = 0; i < drive.scans.size(); ++i) {
    EXPECT_NEAR(found.scans[i].t, drive.scans[i].t, kNanosecond);
    EXPECT_EQ(found.scans[i].ranges, drive.scans[i].ranges);
    EXPECT_EQ(found.scans[i].angle_min, drive.scans[i].angle_min);
    EXPECT_EQ(found.scans[i].angle_increment, drive.scans[i].angle_increment);
    EXPECT_EQ(found.scans[i].time_increment, drive.scans[i].time_increment);
    EXPECT_EQ(found.scans[i].range_min, drive.scans[i].range_min);
    EXPECT_EQ(found.scans[i].range_max, drive.scans[i].range_max);
  }
  ASSERT_EQ(found.gyro.size(), drive.gyro.size());
  for (std::size_t i = 0; i < drive.gyro.size(); ++i) {
    EXPECT_NEAR(found.gyro[i].t, drive.gyro[i].t, kNanosecond);
    EXPECT_EQ(found.gyro[i].yaw_rate, drive.gyro[i].yaw_rate);
  }
}

inline sim::RosLog small_log(sim::Wire wire) { return sim::ros_log(small_drive(), {.wire = wire}); }

inline Result<Recording> read_ros(const std::string& bytes, const TopicChoices& topics = {}) {
  const RobotDescription robot = ros_robot();
  return read_recording_bytes(bytes, "drive", &robot, topics);
}

inline std::string bytes_of(const std::filesystem::path& path) {
  const auto bytes = read_file_bytes(path);
  EXPECT_TRUE(bytes.ok());
  return bytes.ok() ? bytes.value() : "";
}

/// Start of small_drive() in a log, and a millisecond, in ns.
constexpr std::int64_t kRosStart = 1'700'000'000'000'000'000;
constexpr std::int64_t kMillisecond_ns = 1'000'000;

/// The log without a topic's messages.
inline sim::RosLog without_topic(sim::RosLog log, const std::string& topic) {
  std::erase_if(log.messages, [&](const auto& one) { return log.topics[one.topic].name == topic; });
  return log;
}

/// One message of joints, received 3 ms after its stamp.
inline void add_joints(sim::RosLog& log, const std::string& topic, std::int64_t time,
                       const std::vector<std::string>& names, const std::vector<double>& positions,
                       const std::vector<double>& velocities = {}) {
  log.add(topic, "sensor_msgs/JointState", time + 3 * kMillisecond_ns,
          encode_joints(log.wire, {time, ""}, names, positions, velocities));
}

/// All remarks, one a line.
inline std::string all_told(const std::vector<std::string>& remarks) {
  std::string out;
  for (const auto& remark : remarks) out += remark + "\n";
  return out;
}

inline bool told(const Recording& recording, const std::string& words) {
  for (const auto& choice : recording.choices)
    if (choice.find(words) != std::string::npos) return true;
  return false;
}

inline std::size_t discarded_like(const Recording& recording, const std::string& what,
                                  const std::string& words) {
  std::size_t count = 0;
  for (const auto& item : recording.discarded)
    if (item.what == what && item.reason.find(words) != std::string::npos) count += item.count;
  return count;
}

}  // namespace odomcalib::test
