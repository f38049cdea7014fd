// Channels of which the file does not say what they are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/proto/recording/ros_support.hpp"

namespace odomcalib::ros_types_test {
namespace {

using sim::RosLog;
using sim::Wire;
using test::all_told;
using test::read_ros;
using test::small_log;
using test::told;
using ::testing::HasSubstr;

/// The small drive, some of its channels without a schema.
RosLog without_types(const std::vector<std::string>& topics, Wire wire = Wire::cdr_little) {
  RosLog log = small_log(wire);
  for (auto& topic : log.topics)
    if (std::find(topics.begin(), topics.end(), topic.name) != topics.end()) topic.type.clear();
  return log;
}

const std::vector<std::string> kAll{"/joint_states", "/scan", "/odom", "/imu", "/rosout"};

TEST(RosTypes, that_are_not_said_are_told_with_what_to_type) {
  const auto result = read_ros(write_mcap(without_types(kAll)));
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::usage);
  EXPECT_THAT(result.error().text(), HasSubstr("the file does not say what "));
  EXPECT_THAT(result.error().text(), HasSubstr(" are (no schema)"));
  for (const char* line : {"--topic wheels=/joint_states", "--topic scan=/scan", "--topic gyro=/imu"})
    EXPECT_THAT(result.error().text(), HasSubstr(line));
}

TEST(RosTypes, that_are_not_said_are_those_of_the_part_that_is_chosen) {
  for (const Wire wire : {Wire::cdr_little, Wire::cdr2_big, Wire::ros1}) {
    const auto found =
        value_of(read_ros(write_mcap(without_types(kAll, wire)),
                          {{"wheels", "/joint_states", {}}, {"scan", "/scan", {}}, {"gyro", "/imu", {}}}));
    test::expect_small_drive(found, MotionSource::wheels);
    EXPECT_TRUE(told(found, "scan: /scan (sensor_msgs/LaserScan as chosen, 40 messages)"))
        << all_told(found.choices);
    EXPECT_EQ(test::discarded_like(found, "message", "/odom: the file does not say what it is"), 200U);
  }
  const auto odometry = value_of(read_ros(write_mcap(without_types(kAll)), {{"odometry", "/odom", {}}}));
  EXPECT_EQ(odometry.odometry.size(), 200U);
}

TEST(RosTypes, that_are_not_said_of_the_scans_only_are_a_remark) {
  const auto found = value_of(read_ros(write_mcap(without_types({"/scan"}))));
  EXPECT_TRUE(
      told(found, "the file does not say what /scan is (no schema); say what it is: --topic scan=/scan"))
      << all_told(found.choices);
  const auto twin = value_of(read_ros(write_mcap(without_types({}))));
  EXPECT_FALSE(told(twin, "no schema"));
  // Odometry is taken, but wheels would be finer.
  EXPECT_TRUE(told(value_of(read_ros(write_mcap(without_types({"/joint_states"})))),
                   "say what it is: --topic wheels=/joint_states"));
  // Topics that are not needed are only reported as left out.
  EXPECT_FALSE(told(value_of(read_ros(write_mcap(without_types({"/rosout"})))), "no schema"));
}

TEST(RosTypes, that_are_chosen_wrongly_are_refused) {
  const auto result = read_ros(write_mcap(without_types(kAll)), {{"wheels", "/scan", {}}});
  ASSERT_FALSE(result.ok());
  EXPECT_THAT(result.error().text(), HasSubstr("no message of it is one"));
  // A type that the file states is not overruled.
  const auto said = read_ros(write_mcap(without_types({})), {{"wheels", "/scan", {}}});
  ASSERT_FALSE(said.ok());
  EXPECT_THAT(said.error().text(), HasSubstr("cannot be the wheels"));
}

}  // namespace
}  // namespace odomcalib::ros_types_test
