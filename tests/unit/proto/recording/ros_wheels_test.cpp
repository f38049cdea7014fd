// The wheels among the joints of a ROS recording: four of them, each on a topic of its own, or none that the
// names show.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/proto/recording/ros_support.hpp"

namespace odomcalib::ros_wheels_test {
namespace {

using sim::RosLog;
using sim::Wire;
using test::add_joints;
using test::all_told;
using test::kMillisecond_ns;
using test::kRosStart;
using test::read_ros;
using test::small_drive;
using test::told;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kRadPerS = 3.0;

/// Scans of the small drive, without anything that tells the wheels.
RosLog scans_only() {
  return sim::ros_log(small_drive(), {.wire = Wire::cdr_little, .joints = false, .odometry = false});
}

/// Turns of a wheel at a time: each wheel has its own pace.
double angle(double t, double pace) { return pace * kRadPerS * t + 0.2 * std::sin(pace * t); }

/// @param paces of the joints, one a name
RosLog drive_of(const std::vector<std::string>& names, const std::vector<double>& paces) {
  RosLog log = scans_only();
  for (int k = 0; k < 200; ++k) {
    std::vector<double> angles;
    angles.reserve(paces.size());
    for (const double pace : paces) angles.push_back(angle(0.02 * k, pace));
    add_joints(log, "/joint_states", kRosStart + 20 * kMillisecond_ns * k, names, angles);
  }
  return log;
}

std::string error_of(const Result<Recording>& result) { return result ? "read" : result.error().text(); }

TEST(RosWheels, joints_that_do_not_tell_are_named_with_the_line_to_type) {
  const auto refused = read_ros(write_mcap(drive_of({"m1", "m2"}, {1.0, 1.1})));
  EXPECT_THAT(error_of(refused),
              EndsWith("the joints of /joint_states (m1, m2) do not say which are the wheels: "
                       "--topic wheels=/joint_states:LEFT,RIGHT"));
  const auto chosen = value_of(
      read_ros(write_mcap(drive_of({"m1", "m2"}, {1.0, 1.1})), {{"wheels", "/joint_states", {"m1", "m2"}}}));
  EXPECT_EQ(chosen.wheels.size(), 200U);
  const auto twin = value_of(read_ros(write_mcap(drive_of({"m_left", "m_right"}, {1.0, 1.1}))));
  EXPECT_FALSE(told(twin, "do not tell"));
}

TEST(RosWheels, two_topics_of_joints_that_do_not_tell_are_both_named) {
  RosLog log = drive_of({"m1", "m2"}, {1.0, 1.1});
  add_joints(log, "/arm/joint_states", kRosStart, {"elbow"}, {1.0});
  EXPECT_THAT(error_of(read_ros(write_mcap(log))),
              ::testing::AllOf(HasSubstr("/joint_states (m1, m2)"), HasSubstr("/arm/joint_states (elbow)")));
}

TEST(RosWheels, what_was_noticed_comes_with_the_error_that_follows) {
  RosLog log = drive_of({"front_left_wheel", "front_right_wheel", "rear_left_wheel", "rear_right_wheel"},
                        {1.0, 1.1, 1.0, 1.1});
  log.add("/rear/scan", "sensor_msgs/LaserScan", kRosStart,
          encode_scan(log.wire, {kRosStart, "rear"}, small_drive().scans.front()));
  auto result = read_ros(write_mcap(log));
  ASSERT_FALSE(result.ok());
  EXPECT_THAT(result.error().text(), HasSubstr("several topics could be the scan"));
  EXPECT_THAT(all_told(result.error().remarks), HasSubstr("the rear pair is taken"));
  // The dimensions of the robot are missing: an error that comes when all is read.
  result = read_recording_bytes(write_mcap(drive_of({"left", "right"}, {1.0, 1.1})), "drive");
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::missing_units);
  EXPECT_THAT(all_told(result.error().remarks), HasSubstr("wheels: joints left (left) and right (right)"));
}

TEST(RosWheels, a_topic_whose_wheels_say_nothing_is_told_so_and_ticks_are_not_asked_for) {
  RosLog log = scans_only();
  for (int k = 0; k < 50; ++k)
    add_joints(log, "/joint_states", kRosStart + 20 * kMillisecond_ns * k, {"left", "right"},
               {std::nan(""), std::nan("")});
  RobotDescription robot = test::ros_robot();
  robot.ticks_per_rev = 0.0;
  const auto result = read_recording_bytes(write_mcap(log), "drive", &robot);
  EXPECT_THAT(error_of(result), HasSubstr("no message holds the motion of the wheels: 50 x wheels left out"));
}

TEST(RosWheels, of_two_axles_the_rear_one_is_taken_and_the_front_one_offered) {
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"front_left_wheel_joint", "front_right_wheel_joint", "rear_left_wheel_joint",
                                 "rear_right_wheel_joint"},
        {"wheel_fl_joint", "wheel_fr_joint", "wheel_bl_joint", "wheel_br_joint"},
        {"WheelFrontLeft", "WheelFrontRight", "WheelBackLeft", "WheelBackRight"},
        {"lf_wheel", "rf_wheel", "lr_wheel", "rr_wheel"},
        {"left_front", "right_front", "left_rear", "right_rear"}}) {
    const std::string bytes = write_mcap(drive_of(names, {1.01, 1.11, 1.0, 1.1}));
    const auto rear = value_of(read_ros(bytes));
    EXPECT_TRUE(told(rear, "joints " + names[2] + " (left) and " + names[3] + " (right)"))
        << all_told(rear.choices);
    EXPECT_TRUE(told(rear, "the rear pair is taken; the front pair: --topic wheels=/joint_states:" +
                               names[0] + "," + names[1]));
    EXPECT_FALSE(told(rear, "otherwise")) << all_told(rear.choices);
    EXPECT_NEAR(rear.wheels[50].left, angle(1.0, 1.0), 1e-9);
    const auto choice = value_of(parse_topic_choice("wheels=/joint_states:" + names[0] + "," + names[1]));
    const auto front = value_of(read_ros(bytes, {choice}));
    EXPECT_NEAR(front.wheels[50].left, angle(1.0, 1.01), 1e-9);
  }
}

TEST(RosWheels, axles_that_turn_otherwise_are_told_whichever_is_taken) {
  const std::vector<std::string> names{"front_left_wheel", "front_right_wheel", "rear_left_wheel",
                                       "rear_right_wheel"};
  // Steered wheels go a longer way; those of a mecanum base that strafes turn against each other.
  for (const double front : {1.3, -1.0}) {
    const std::string bytes = write_mcap(drive_of(names, {front, front, 1.0, 1.0}));
    EXPECT_TRUE(
        told(value_of(read_ros(bytes)), front > 0.0 ? "by 25 % of their way on the left" : "by 200 % of"))
        << all_told(value_of(read_ros(bytes)).choices);
    EXPECT_TRUE(told(value_of(read_ros(bytes, {{"wheels", "/joint_states", {names[0], names[1]}}})),
                     "they are steered, slip, or the robot moves sideways"));
  }
}

TEST(RosWheels, axles_that_turn_otherwise_are_told_by_their_speeds_too) {
  for (const double front : {1.0, 1.2}) {
    RosLog log = scans_only();
    for (int k = 0; k < 200; ++k)
      add_joints(log, "/joint_states", kRosStart + 20 * kMillisecond_ns * k,
                 {"fl_wheel", "fr_wheel", "rl_wheel", "rr_wheel"}, {}, {2.0 * front, 2.0 * front, 2.0, 2.0});
    EXPECT_EQ(told(value_of(read_ros(write_mcap(log))), "by 18 % of their way on the left"), front > 1.0);
  }
}

TEST(RosWheels, casters_and_joints_that_steer_are_no_wheels_that_drive) {
  const auto casters = value_of(read_ros(write_mcap(drive_of(
      {"left_wheel", "right_wheel", "left_caster_wheel", "right_caster_wheel"}, {1.0, 1.1, 2.0, 2.0}))));
  EXPECT_TRUE(told(casters, "joints left_wheel (left) and right_wheel (right)"));
  const auto car = value_of(read_ros(write_mcap(drive_of(
      {"front_left_wheel_steering_joint", "front_right_wheel_steering_joint", "left_wheel", "right_wheel"},
      {0.0, 0.0, 1.0, 1.1}))));
  EXPECT_TRUE(told(car, "joints left_wheel (left) and right_wheel (right)"));
  EXPECT_FALSE(told(car, "rear pair"));
}

TEST(RosWheels, three_axles_and_arms_have_to_be_chosen) {
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"front_left_wheel", "middle_left_wheel", "rear_left_wheel",
                                 "front_right_wheel", "middle_right_wheel", "rear_right_wheel"},
        {"left_wheel_1", "left_wheel_2", "right_wheel_1", "right_wheel_2"},
        {"left_front_finger", "left_rear_finger", "right_front_finger", "right_rear_finger", "neck"},
        {"arm_l", "arm_r"}})
    EXPECT_THAT(error_of(read_ros(write_mcap(drive_of(names, std::vector<double>(names.size(), 1.0))))),
                HasSubstr("do not say which are the wheels"))
        << names.front();
}

/// The left and the right wheel in turn.
RosLog in_turn(const std::string& left_topic, const std::string& left, const std::string& right_topic,
               const std::string& right, bool speeds = false) {
  RosLog log = scans_only();
  for (int k = 0; k < 200; ++k) {
    const std::int64_t time = kRosStart + 20 * kMillisecond_ns * k;
    const double t = 0.02 * k;
    const std::vector<double> l{speeds ? 2.0 : kRadPerS * t}, r{speeds ? 2.5 : 1.1 * kRadPerS * (t + 0.009)};
    add_joints(log, left_topic, time, {left}, speeds ? std::vector<double>{} : l, l);
    add_joints(log, right_topic, time + 9 * kMillisecond_ns, {right}, speeds ? std::vector<double>{} : r, r);
  }
  return log;
}

void expect_joined(const Recording& found) {
  EXPECT_EQ(found.motion, MotionSource::wheels);
  // Before the first of the right wheel there is nothing to go between.
  ASSERT_EQ(found.wheels.size(), 199U) << test::list_discarded(found);
  for (const WheelSample& one : found.wheels) EXPECT_NEAR(one.right, 1.1 * one.left, 1e-9);
  EXPECT_TRUE(told(found, "each sample has one wheel only (200 left, 200 right)")) << all_told(found.choices);
}

TEST(RosWheels, one_in_a_message_are_brought_to_one_instant) {
  expect_joined(value_of(read_ros(write_mcap(in_turn("/joint_states", "left", "/joint_states", "right")))));
  const auto twin = value_of(read_ros(write_mcap(drive_of({"left", "right"}, {1.0, 1.1}))));
  EXPECT_FALSE(told(twin, "one wheel only"));
}

TEST(RosWheels, on_topics_of_their_own_are_brought_to_one_instant) {
  for (const auto& [left_topic, left, right_topic, right] :
       {std::array<const char*, 4>{"/left_wheel/state", "left_wheel", "/right_wheel/state", "right_wheel"},
        {"/left_wheel/state", "joint", "/right_wheel/state", "joint"},
        {"/wheel_l/joint_states", "wheel", "/wheel_r/joint_states", "wheel"}}) {
    const std::string bytes = write_mcap(in_turn(left_topic, left, right_topic, right));
    expect_joined(value_of(read_ros(bytes)));
    const auto choice = value_of(parse_topic_choice("wheels=" + std::string(left_topic) + "," + right_topic));
    expect_joined(value_of(read_ros(bytes, {choice})));
  }
}

TEST(RosWheels, on_topics_of_their_own_decide_over_odometry_and_may_be_speeds) {
  RosLog log = in_turn("/left_wheel/state", "w", "/right_wheel/state", "w", true);
  log.add("/odom", "nav_msgs/Odometry", kRosStart,
          encode_odometry(log.wire, {kRosStart, "odom"}, "base_link", {0.0, 0.0, 0.0}));
  const auto found = value_of(read_ros(write_mcap(log)));
  EXPECT_EQ(found.motion, MotionSource::wheel_speeds);
  EXPECT_TRUE(told(found, "there are no angles"));
  EXPECT_TRUE(told(found, "--topic odometry=/odom"));
  ASSERT_GT(found.wheel_speeds.size(), 190U);
  EXPECT_EQ(found.wheel_speeds.back().right, 2.5);
}

TEST(RosWheels, on_more_topics_than_two_have_to_be_chosen) {
  RosLog log = in_turn("/left_wheel/state", "w", "/right_wheel/state", "w");
  for (int k = 0; k < 9; ++k)
    add_joints(log, "/left_arm/state", kRosStart + 20 * kMillisecond_ns * k, {"left_elbow"}, {0.1});
  EXPECT_THAT(error_of(read_ros(write_mcap(log))), HasSubstr("--topic wheels="));
  const auto choice = value_of(parse_topic_choice("wheels=/left_wheel/state,/right_wheel/state"));
  expect_joined(value_of(read_ros(write_mcap(log), {choice})));
}

TEST(RosWheels, that_are_one_wheel_only_are_refused_for_that) {
  const RosLog log = test::without_topic(in_turn("/left", "left", "/joint_states", "right"), "/left");
  EXPECT_THAT(error_of(read_ros(write_mcap(log), {{"wheels", "/joint_states", {"right", "right"}}})),
              Not(HasSubstr("ticks")));
  EXPECT_THAT(error_of(read_ros(write_mcap(log))), HasSubstr("/joint_states (right) do not say"));
}

TEST(RosWheels, the_choice_of_two_topics_is_read) {
  const auto choice = value_of(parse_topic_choice("wheel_speeds=/a/left,/a/right"));
  EXPECT_EQ(choice.topic, "/a/left");
  EXPECT_EQ(choice.right_topic, "/a/right");
  for (const char* wrong : {"wheels=/a,", "wheels=,/a", "wheels=/a,/b:c,d", "scan=/a,/b", "odometry=/a,/b"})
    EXPECT_FALSE(parse_topic_choice(wrong).ok()) << wrong;
}

}  // namespace
}  // namespace odomcalib::ros_wheels_test
