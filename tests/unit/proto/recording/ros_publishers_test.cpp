// Several publishers on one topic of a ROS recording: lists of joints, frames of scans, of odometry and of
// poses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/proto/recording/ros_support.hpp"

namespace odomcalib::ros_publishers_test {
namespace {

using sim::RosLog;
using sim::Wire;
using test::add_joints;
using test::all_told;
using test::discarded_like;
using test::kMillisecond_ns;
using test::kRosStart;
using test::read_ros;
using test::small_drive;
using test::small_log;
using test::told;
using ::testing::HasSubstr;

using Names = std::vector<std::string>;

/// The small drive with a second list of names between its joint states.
/// @param value of both wheels, by the number of the message
template <typename Value>
RosLog with_second_list(const Names& names, Value value) {
  RosLog log = small_log(Wire::cdr_little);
  for (int k = 0; k < 190; ++k)
    add_joints(log, "/joint_states", kRosStart + (20 * k + 7) * kMillisecond_ns, names,
               std::vector<double>(names.size(), value(k)));
  return log;
}

const Names kOther{"wheel_left_joint", "wheel_right_joint"};

TEST(RosPublishers, of_joints_that_never_change_are_left_out_and_named) {
  const auto found = value_of(read_ros(write_mcap(with_second_list(kOther, [](int) { return 0.0; }))));
  test::expect_small_drive(found, MotionSource::wheels);
  EXPECT_TRUE(told(found,
                   "(lift_joint, wheel_right_joint, wheel_left_joint), 200 messages, are taken; those of "
                   "(wheel_left_joint, wheel_right_joint), 190 messages, never change"))
      << all_told(found.choices);
  EXPECT_EQ(discarded_like(found, "message", "never change"), 190U);
  const auto twin = value_of(read_ros(write_mcap(small_log(Wire::cdr_little))));
  EXPECT_FALSE(told(twin, "never change"));
}

TEST(RosPublishers, of_joints_of_which_one_tells_speeds_only_are_no_two) {
  RosLog log = small_log(Wire::cdr_little);
  for (int k = 0; k < 190; ++k)
    add_joints(log, "/joint_states", kRosStart + (20 * k + 7) * kMillisecond_ns, kOther, {}, {0.5, 0.5});
  const auto found = value_of(read_ros(write_mcap(log)));
  test::expect_small_drive(found, MotionSource::wheels);
  EXPECT_FALSE(told(found, "never change"));
}

TEST(RosPublishers, of_joints_that_tell_different_motions_are_refused_with_both_lists) {
  const auto result =
      read_ros(write_mcap(with_second_list(kOther, [](int k) { return 40.0 + std::sin(0.3 * k); })));
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::usage);
  EXPECT_THAT(result.error().text(),
              ::testing::AllOf(HasSubstr("(lift_joint, wheel_right_joint, wheel_left_joint), 200 messages"),
                               HasSubstr("(wheel_left_joint, wheel_right_joint), 190 messages"),
                               HasSubstr("--topic odometry=/odom")));
}

/// A driver that lists its joints in another order now and then tells one motion.
TEST(RosPublishers, of_joints_that_agree_are_one) {
  RosLog log = test::without_topic(small_log(Wire::cdr_little), "/joint_states");
  for (int k = 0; k < 200; ++k) {
    const Names names = k % 3 == 0 ? Names{"wheel_right_joint", "wheel_left_joint"} : kOther;
    const double left = 0.1 * k, right = 0.12 * k;
    add_joints(log, "/joint_states", kRosStart + 20 * kMillisecond_ns * k, names,
               k % 3 == 0 ? std::vector<double>{right, left} : std::vector<double>{left, right});
  }
  const auto found = value_of(read_ros(write_mcap(log)));
  ASSERT_EQ(found.wheels.size(), 200U);
  EXPECT_NEAR(found.wheels[99].left, 9.9, 1e-12);
}

TEST(RosPublishers, of_joints_of_a_robot_that_stands_are_not_told_apart) {
  RosLog log = test::without_topic(with_second_list(kOther, [](int) { return 1.0; }), "/nothing");
  std::erase_if(log.messages, [&](const auto& one) {
    return log.topics[one.topic].name == "/joint_states" && one.bytes.find("lift") != std::string::npos;
  });
  for (int k = 0; k < 50; ++k)
    add_joints(log, "/joint_states", kRosStart + (20 * k + 3) * kMillisecond_ns,
               {"wheel_right_joint", "wheel_left_joint"}, {1.0, 1.0});
  std::stable_sort(log.messages.begin(), log.messages.end(),
                   [](const auto& a, const auto& b) { return a.received_ns < b.received_ns; });
  const auto found = value_of(read_ros(write_mcap(log)));
  EXPECT_EQ(found.wheels.size(), 240U);
  EXPECT_FALSE(told(found, "never change"));
}

/// Every second scan in another frame.
RosLog two_lidars(const std::string& first, const std::string& second) {
  const Recording drive = small_drive();
  RosLog log = test::without_topic(small_log(Wire::cdr_little), "/scan");
  for (std::size_t k = 0; k < drive.scans.size(); ++k) {
    const std::int64_t time = kRosStart + std::llround(1e9 * drive.scans[k].t);
    log.add("/scan", "sensor_msgs/LaserScan", time + 30 * kMillisecond_ns,
            encode_scan(log.wire, {time, k % 4 == 3 ? second : first}, drive.scans[k]));
  }
  return log;
}

TEST(RosPublishers, of_scans_are_told_by_their_frames_and_become_sensors) {
  const auto found = value_of(read_ros(write_mcap(two_lidars("front_laser", "rear_laser"))));
  ASSERT_EQ(found.scans.size(), 40U);
  EXPECT_EQ(found.scans[0].sensor, "front_laser");
  EXPECT_EQ(found.scans[3].sensor, "rear_laser");
  EXPECT_TRUE(
      told(found, "/scan has scans of several frames: front_laser (30 scans), rear_laser (10 scans)"));
}

TEST(RosPublishers, of_scans_in_one_frame_are_one_sensor_without_a_name) {
  for (const char* second : {"laser", "/laser"}) {
    const auto found = value_of(read_ros(write_mcap(two_lidars("laser", second))));
    for (const Scan& scan : found.scans) EXPECT_EQ(scan.sensor, "");
    EXPECT_FALSE(told(found, "several frames"));
  }
}

/// Odometry or poses, every fourth in another frame and elsewhere.
RosLog two_frames(bool odometry, const sim::RosHeader& header, const std::string& child,
                  const std::string& other_child, const std::string& other_frame) {
  RosLog log =
      test::without_topic(test::without_topic(small_log(Wire::cdr_little), "/joint_states"), "/odom");
  for (int k = 0; k < 100; ++k) {
    const std::int64_t time = kRosStart + 40 * kMillisecond_ns * k;
    const bool other = k % 4 == 0;
    const sim::RosHeader own{time, other ? other_frame : header.frame};
    const std::array<double, 3> pose{0.01 * k + (other ? 5.0 : 0.0), 0.0, 0.0};
    if (odometry)
      log.add("/odom", "nav_msgs/Odometry", time,
              encode_odometry(log.wire, own, other ? other_child : child, pose));
    else
      log.add("/pose", "geometry_msgs/PoseStamped", time, encode_pose(log.wire, own, pose));
  }
  return log;
}

TEST(RosPublishers, of_odometry_in_two_frames_are_told_and_the_one_with_more_is_taken) {
  auto found = value_of(read_ros(write_mcap(two_frames(true, {0, "odom"}, "base_link", "imu_link", "odom"))));
  EXPECT_EQ(found.odometry.size(), 75U);
  EXPECT_TRUE(
      told(found, "base_link in odom, 75 messages, is taken; not taken: imu_link in odom, 25 messages"))
      << all_told(found.choices);
  EXPECT_TRUE(told(found, "odometry of the frame base_link"));
  EXPECT_EQ(discarded_like(found, "message", "of imu_link in odom"), 25U);
  found = value_of(read_ros(write_mcap(two_frames(true, {0, "odom"}, "base_link", "base_link", "map"))));
  EXPECT_EQ(found.odometry.size(), 75U);
  found = value_of(read_ros(write_mcap(two_frames(true, {0, "odom"}, "base_link", "base_link", "odom"))));
  EXPECT_EQ(found.odometry.size(), 100U);
  EXPECT_FALSE(told(found, "several frames"));
}

TEST(RosPublishers, of_poses_in_two_frames_are_told_and_the_one_with_more_is_taken) {
  RosLog log = two_frames(false, {0, "map"}, "", "", "camera");
  for (int k = 0; k < 50; ++k)
    add_joints(log, "/joint_states", kRosStart + 80 * kMillisecond_ns * k, {"left", "right"},
               {0.1 * k, 0.1 * k});
  const auto found = value_of(read_ros(write_mcap(log), {{"pose", "/pose", {}}}));
  EXPECT_EQ(found.poses.size(), 75U);
  EXPECT_TRUE(told(found, "map, 75 messages, is taken; not taken: camera, 25 messages"));
}

TEST(RosPublishers, of_rates_in_two_frames_are_told_and_the_one_with_more_is_taken) {
  RosLog log = small_log(Wire::cdr_little);
  for (int k = 0; k < 12; ++k)
    log.add("/imu", "sensor_msgs/Imu", kRosStart + (100 * k + 50) * kMillisecond_ns,
            encode_imu(log.wire, {kRosStart + (100 * k + 50) * kMillisecond_ns, "arm_imu"}, 7.0));
  const auto found = value_of(read_ros(write_mcap(log)));
  test::expect_small_drive(found, MotionSource::wheels);
  EXPECT_TRUE(told(found, "not taken: arm_imu, 12 messages"));
}

}  // namespace
}  // namespace odomcalib::ros_publishers_test
