// Assignment of the topics of a ROS recording, and the remarks on it.
#include <gtest/gtest.h>

#include "tests/unit/proto/recording/ros_support.hpp"

namespace odomcalib::ros_topics_test {
namespace {

using sim::Wire;
using test::discarded_like;
using test::expect_small_drive;
using test::list_discarded;
using test::read_ros;
using test::ros_robot;
using test::small_drive;
using test::small_log;
using test::told;

constexpr std::int64_t kStart = 1'700'000'000'000'000'000;
constexpr std::int64_t kMillisecond = 1'000'000;

std::string mcap(const sim::RosLog& log) { return write_mcap(log); }

void expect_usage(const Result<Recording>& result, const std::vector<std::string>& words,
                  ErrorCode code = ErrorCode::usage) {
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, code) << result.error().text();
  for (const auto& word : words)
    EXPECT_NE(result.error().text().find(word), std::string::npos) << word << ": " << result.error().text();
}

void add_scan(sim::RosLog& log, const std::string& topic) {
  const Scan scan = small_drive().scans.front();
  log.add(topic, "sensor_msgs/LaserScan", kStart, encode_scan(log.wire, {kStart, "laser"}, scan));
}

void add_pose(sim::RosLog& log, const std::string& topic, int count = 3) {
  for (int k = 0; k < count; ++k) {
    const std::int64_t time = kStart + 100 * kMillisecond * k;
    log.add(topic, "geometry_msgs/PoseStamped", time,
            encode_pose(log.wire, {time, "map"}, {0.1 * k, 0.2, 0.3}));
  }
}

/// Two wheels of a joint state with these names.
sim::RosLog joints_log(const std::vector<std::string>& names, bool positions = true,
                       bool velocities = false) {
  sim::RosLog log =
      sim::ros_log(small_drive(), {.wire = Wire::cdr_little, .joints = false, .odometry = false});
  for (int k = 0; k < 50; ++k) {
    const std::int64_t time = kStart + 20 * kMillisecond * k;
    const std::vector<double> values(names.size(), 0.1 * k);
    log.add("/joint_states", "sensor_msgs/JointState", time,
            encode_joints(log.wire, {time, ""}, names, positions ? values : std::vector<double>{},
                          velocities ? values : std::vector<double>{}));
  }
  return log;
}

TEST(TopicChoice, is_read_in_all_its_forms) {
  const auto scan = value_of(parse_topic_choice("scan=/front/scan"));
  EXPECT_EQ(scan.part, "scan");
  EXPECT_EQ(scan.topic, "/front/scan");
  const auto wheels = value_of(parse_topic_choice("wheels=/joint_states:left_joint,right_joint"));
  EXPECT_EQ(wheels.joints, (std::vector<std::string>{"left_joint", "right_joint"}));
  EXPECT_TRUE(parse_topic_choice("wheels=/joint_states").ok());
  for (const char* wrong :
       {"", "scan", "scan=", "camera=/x", "wheels=/joint_states:left", "scan=/scan:a,b", "=/x"}) {
    const auto result = parse_topic_choice(wrong);
    ASSERT_FALSE(result.ok()) << wrong;
    EXPECT_EQ(result.error().code, ErrorCode::usage);
  }
}

TEST(RosTopics, odometry_decides_where_there_are_no_joints_or_where_it_is_chosen) {
  const auto alone =
      value_of(read_ros(mcap(sim::ros_log(small_drive(), {.wire = Wire::cdr_little, .joints = false}))));
  expect_small_drive(alone, MotionSource::odometry);
  EXPECT_TRUE(told(alone, "odometry of the frame base_link: /odom"));
  const auto chosen = value_of(read_ros(mcap(small_log(Wire::cdr_little)), {{"odometry", "/odom", {}}}));
  expect_small_drive(chosen, MotionSource::odometry);
  EXPECT_EQ(discarded_like(chosen, "message", "/joint_states was not taken"), 200U);
}

TEST(RosTopics, two_scanners_have_to_be_chosen_between) {
  sim::RosLog log = small_log(Wire::cdr_little);
  add_scan(log, "/rear/scan");
  expect_usage(read_ros(mcap(log)),
               {"several topics could be the scan", "/scan (sensor_msgs/msg/LaserScan, 40 messages)",
                "/rear/scan", "--topic scan="});
  const auto chosen = value_of(read_ros(mcap(log), {{"scan", "/scan", {}}}));
  expect_small_drive(chosen, MotionSource::wheels);
  EXPECT_EQ(discarded_like(chosen, "message", "/rear/scan was not taken"), 1U);
}

TEST(RosTopics, that_do_not_exist_or_do_not_fit_are_refused_with_the_list_of_those_that_do) {
  const std::string bytes = mcap(small_log(Wire::cdr_little));
  expect_usage(
      read_ros(bytes, {{"scan", "/laser", {}}}),
      {"there is no topic \"/laser\"", "/scan (sensor_msgs/msg/LaserScan", "/rosout (std_msgs/msg/String"});
  expect_usage(read_ros(bytes, {{"scan", "/odom", {}}}),
               {"/odom (nav_msgs/msg/Odometry", "cannot be the scan", "sensor_msgs/LaserScan"});
  expect_usage(read_ros(bytes, {{"scan", "/rosout", {}}}), {"cannot be the scan"});
  expect_usage(read_ros(bytes, {{"scan", "/scan", {}}, {"scan", "/scan", {}}}),
               {"two topics are chosen as scan"});
  expect_usage(read_ros(bytes, {{"wheels", "/joint_states", {}}, {"wheel_speeds", "/joint_states", {}}}),
               {"two topics are chosen"});
  expect_usage(read_ros(bytes, {{"wheels", "/joint_states", {"left", "wheel_right_joint"}}}),
               {"has no joint \"left\"", "lift_joint, wheel_right_joint, wheel_left_joint"});
}

TEST(RosTopics, other_recordings_have_none) {
  const auto result = read_recording_bytes(test::kRobotLine, "drive.jsonl", nullptr, {{"scan", "/scan", {}}});
  expect_usage(result, {"no topics"});
}

TEST(RosTopics, without_wheel_motion_are_refused_with_what_there_is) {
  sim::RosLog log = sim::ros_log(small_drive(), {.wire = Wire::ros1, .joints = false, .odometry = false});
  expect_usage(read_ros(mcap(log)),
               {"no topic holds the motion", "/scan (sensor_msgs/LaserScan, 40 messages)"}, ErrorCode::empty);
}

TEST(RosTopics, wheels_are_recognised_by_the_names_of_their_joints) {
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"left_wheel_joint", "right_wheel_joint"},
        {"wheel_right", "wheel_left"},
        {"LeftDrive", "RightDrive"},
        {"left_arm", "right_arm", "left_wheel", "right_wheel"}}) {
    const auto result = read_ros(mcap(joints_log(names)));
    ASSERT_TRUE(result.ok()) << names.front() << result.error().text();
    EXPECT_EQ(result.value().motion, MotionSource::wheels);
  }
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"joint_1", "joint_2"},
        {"wheel_1_left", "wheel_1_right", "wheel_2_left", "wheel_2_right"}}) {
    const auto refused = read_ros(mcap(joints_log(names)));
    expect_usage(refused, {"do not say which are the wheels", "--topic wheels=/joint_states:LEFT,RIGHT"});
    const auto chosen =
        value_of(read_ros(mcap(joints_log(names)), {{"wheels", "/joint_states", {names[0], names[1]}}}));
    EXPECT_EQ(chosen.ticks.size(), 50U);
    expect_usage(read_ros(mcap(joints_log(names)), {{"wheels", "/joint_states", {}}}),
                 {"do not say which are the wheels", names.front(), ":LEFT,RIGHT"});
  }
}

/// Joints whose angles are always the same, as some drivers fill them in.
sim::RosLog filled_in(double speed) {
  sim::RosLog log =
      sim::ros_log(small_drive(), {.wire = Wire::cdr_little, .joints = false, .odometry = false});
  for (int k = 0; k < 50; ++k)
    test::add_joints(log, "/joint_states", test::kRosStart + 20 * test::kMillisecond_ns * k,
                     {"left", "right"}, {0.0, 0.0}, {speed * (1.0 + 0.01 * k), speed});
  return log;
}

TEST(RosTopics, angles_that_never_change_beside_speeds_give_speeds) {
  const auto result = value_of(read_ros(mcap(filled_in(3.0))));
  EXPECT_EQ(result.motion, MotionSource::wheel_speeds);
  EXPECT_EQ(result.wheel_speeds.size(), 50U);
  EXPECT_TRUE(told(result, "or they never change"));
  EXPECT_EQ(value_of(read_ros(mcap(filled_in(0.0)))).motion, MotionSource::wheels) << "the robot stood";
}

TEST(RosTopics, angles_that_are_no_numbers_beside_speeds_give_speeds) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  // One wheel has none or both have none, in all messages or but for some that never change.
  for (const auto& [left, right, from] : {std::tuple{kNone, kNone, 0}, {kNone, 0.5, 0}, {kNone, kNone, 5}}) {
    sim::RosLog log =
        sim::ros_log(small_drive(), {.wire = Wire::cdr_little, .joints = false, .odometry = false});
    for (int k = 0; k < 50; ++k) {
      const std::vector<double> angles = k < from ? std::vector{0.0, 0.0} : std::vector{left, right + k};
      test::add_joints(log, "/joint_states", test::kRosStart + 20 * test::kMillisecond_ns * k,
                       {"left", "right"}, angles, {3.0, 2.0});
    }
    const auto result = value_of(read_ros(mcap(log)));
    EXPECT_EQ(result.motion, MotionSource::wheel_speeds);
    EXPECT_EQ(result.wheel_speeds.size(), 50U) << list_discarded(result);
  }
}

TEST(RosTopics, joints_that_have_no_value_for_the_wheels_are_counted_among_them) {
  sim::RosLog log = joints_log({"left", "right"});
  for (int k = 0; k < 5; ++k)
    test::add_joints(log, "/joint_states", test::kRosStart + 1000 * test::kMillisecond_ns + k,
                     {"left", "right"}, {1.0});
  const auto result = value_of(read_ros(mcap(log)));
  EXPECT_EQ(discarded_like(result, "wheels", "/joint_states: no values for the joints of the wheels"), 5U)
      << list_discarded(result);
}

TEST(RosTopics, joints_without_angles_give_speeds) {
  const auto result = value_of(read_ros(mcap(joints_log({"left", "right"}, false, true))));
  EXPECT_EQ(result.motion, MotionSource::wheel_speeds);
  EXPECT_TRUE(told(result, "there are no angles"));
  const auto chosen = value_of(
      read_ros(mcap(joints_log({"left", "right"}, true, true)), {{"wheel_speeds", "/joint_states", {}}}));
  EXPECT_EQ(chosen.motion, MotionSource::wheel_speeds);
}

/// Several publishers share /joint_states: an arm's messages lack the wheels, and orders differ.
TEST(RosTopics, joints_are_found_by_name_in_every_message) {
  sim::RosLog log = joints_log({"left", "right"});
  for (int k = 0; k < 50; ++k) {
    const std::int64_t time = kStart + 20 * kMillisecond * k + 5 * kMillisecond;
    log.add("/joint_states", "sensor_msgs/JointState", time,
            encode_joints(log.wire, {time, ""}, {"elbow"}, {1.0}, {}));
    log.add(
        "/joint_states", "sensor_msgs/JointState", time + kMillisecond,
        encode_joints(log.wire, {time + kMillisecond, ""}, {"right", "left"}, {0.1 * k, 0.1 * k + 0.01}, {}));
  }
  const Recording r = value_of(read_ros(mcap(log)));
  EXPECT_EQ(r.wheels.size(), 100U);
  EXPECT_EQ(discarded_like(r, "message", "without the joints of the wheels"), 50U);
  for (const WheelSample& sample : r.wheels) EXPECT_LT(sample.left - sample.right, 0.011);
  EXPECT_NEAR(r.wheels[1].left - r.wheels[1].right, 0.01, 1e-12);
}

/// A goal is a PoseStamped too.
TEST(RosTopics, poses_are_taken_unasked_only_where_there_are_no_scans) {
  sim::RosLog log = small_log(Wire::cdr_little);
  add_pose(log, "/goal_pose");
  auto result = value_of(read_ros(mcap(log)));
  EXPECT_TRUE(result.poses.empty());
  EXPECT_TRUE(told(result, "--topic pose=/goal_pose"));
  result = value_of(read_ros(mcap(log), {{"pose", "/goal_pose", {}}}));
  ASSERT_EQ(result.poses.size(), 3U);
  EXPECT_NEAR(result.poses[2].yaw, 0.3, 1e-12);
  result = value_of(read_ros(mcap(log), {{"pose", "/odom", {}}}));
  EXPECT_EQ(result.poses.size(), 200U);

  Recording without_scans = small_drive();
  without_scans.scans.clear();
  sim::RosLog mocap = sim::ros_log(without_scans, {.wire = Wire::cdr_little});
  result = value_of(read_ros(mcap(mocap)));
  EXPECT_TRUE(told(result, "no topic with scans or poses"));
  add_pose(mocap, "/mocap/robot/pose");
  result = value_of(read_ros(mcap(mocap)));
  EXPECT_EQ(result.poses.size(), 3U);
  add_pose(mocap, "/goal_pose");
  expect_usage(read_ros(mcap(mocap)), {"several topics could be the pose"});
}

TEST(RosTopics, a_second_gyro_stops_nobody) {
  sim::RosLog log = small_log(Wire::cdr_little);
  log.add("/camera/imu", "sensor_msgs/Imu", kStart, encode_imu(log.wire, {kStart, "camera"}, 0.5));
  auto result = value_of(read_ros(mcap(log)));
  EXPECT_TRUE(result.gyro.empty());
  EXPECT_TRUE(told(result, "several topics could be the gyro"));
  result = value_of(read_ros(mcap(log), {{"gyro", "/imu", {}}}));
  expect_small_drive(result, MotionSource::wheels);
}

TEST(RosTopics, an_imu_that_states_no_rates_has_none) {
  sim::RosLog log = small_log(Wire::cdr_little);
  log.add("/imu", "sensor_msgs/Imu", kStart, encode_imu(log.wire, {kStart, "imu"}, 0.5, -1.0));
  const auto result = value_of(read_ros(mcap(log)));
  EXPECT_EQ(result.gyro.size(), 40U);
  EXPECT_EQ(discarded_like(result, "gyro", "/imu: does not hold"), 1U);
}

TEST(RosTopics, stamps_of_headers_are_used_and_those_that_are_zero_replaced_by_reception) {
  sim::RosLog log = small_log(Wire::cdr_little);
  for (auto& message : log.messages)
    if (log.topics[message.topic].name == "/scan")
      message.bytes = encode_scan(log.wire, {0, "laser"}, small_drive().scans.front());
  const auto result = value_of(read_ros(mcap(log)));
  ASSERT_EQ(result.scans.size(), 40U);
  // 3 ms on the way, and the 25 beams of a scan
  EXPECT_NEAR(result.scans[0].t, 0.003 + 0.003 + 25.0 / 1024.0, 1e-6);
  EXPECT_EQ(result.ticks[1].t, 0.02);
}

TEST(RosTopics, stamps_of_different_clocks_are_replaced_by_reception_and_it_is_said) {
  sim::RosLog log = small_log(Wire::cdr_little);
  std::size_t k = 0;
  for (auto& message : log.messages)
    if (log.topics[message.topic].name == "/scan") {
      const Scan scan = small_drive().scans[k++];
      message.bytes = encode_scan(log.wire, {17'000'000'000 + std::llround(1e9 * scan.t), "laser"}, scan);
    }
  const auto result = value_of(read_ros(mcap(log)));
  EXPECT_TRUE(told(result, "times of reception"));
  ASSERT_EQ(result.scans.size(), 40U);
  EXPECT_NEAR(result.scans[0].t, 0.006 + 25.0 / 1024.0, 1e-6);
  EXPECT_NEAR(result.ticks[0].t, 0.003, 1e-6);
  // A whole recording that was played back hours later is one clock.
  sim::RosLog replayed = small_log(Wire::cdr_little);
  for (auto& message : replayed.messages) message.received_ns += 7'200'000'000'000;
  const auto played = value_of(read_ros(mcap(replayed)));
  expect_small_drive(played, MotionSource::wheels);
  EXPECT_FALSE(told(played, "times of reception"));
}

/// REP 117: too near, too far, no echo, no number.
TEST(RosTopics, ranges_that_are_not_finite_are_no_reading_and_no_fault) {
  sim::RosLog log = small_log(Wire::cdr_little);
  Scan scan = small_drive().scans.back();
  scan.ranges[0] = std::numeric_limits<float>::quiet_NaN();
  scan.ranges[1] = -std::numeric_limits<float>::infinity();
  scan.ranges[2] = std::numeric_limits<float>::infinity();
  scan.ranges[3] = 9.0F;  // beyond range_max
  const std::int64_t time = kStart + 5000 * kMillisecond;
  log.add("/scan", "sensor_msgs/LaserScan", time, encode_scan(log.wire, {time, "laser"}, scan));
  const auto result = value_of(read_ros(mcap(log)));
  const auto& ranges = result.scans.back().ranges;
  for (int k = 0; k < 4; ++k) EXPECT_EQ(ranges[static_cast<std::size_t>(k)], 0.0F) << k;
  EXPECT_EQ(ranges[4], scan.ranges[4]);
  EXPECT_EQ(discarded_like(result, "beam", "not a number"), 0U) << list_discarded(result);
  EXPECT_EQ(discarded_like(result, "beam", "outside"), 1U);
}

TEST(RosTopics, types_of_another_definition_and_encodings_that_are_not_read_are_named) {
  std::string bag = write_bag(small_log(Wire::ros1), {.chunk_bytes = 100'000'000});
  const std::string md5 = sim::md5_of("sensor_msgs/LaserScan");
  for (auto at = bag.find(md5); at != std::string::npos; at = bag.find(md5)) bag[at] = 'f';
  const auto result = value_of(read_ros(bag));
  EXPECT_TRUE(result.scans.empty());
  EXPECT_TRUE(told(result, "not read: of another definition (MD5 f"));
  EXPECT_EQ(discarded_like(result, "message", "of another definition"), 40U);

  std::string file = write_mcap(small_log(Wire::cdr_little), {.chunk_bytes = 0});
  const std::string scan = "/scan" + std::string("\x03\0\0\0cdr", 7);
  ASSERT_NE(file.find(scan), std::string::npos);
  file.replace(file.find(scan) + 9, 3, "xml");
  const auto other = value_of(read_ros(file));
  EXPECT_TRUE(told(other, "in the encoding \"xml\""));
}

TEST(RosTopics, without_dimensions_of_the_robot_ask_for_them) {
  const auto result = read_recording_bytes(mcap(small_log(Wire::cdr_little)), "drive.mcap");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::missing_units);
  EXPECT_NE(result.error().text().find("--robot"), std::string::npos) << result.error().text();
}

}  // namespace
}  // namespace odomcalib::ros_topics_test
