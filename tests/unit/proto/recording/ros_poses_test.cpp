// Poses of ROS recordings that are none: orientations that are no rotation, and a pose that nobody moves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

#include "tests/unit/proto/recording/ros_support.hpp"

namespace odomcalib::ros_poses_test {
namespace {

using sim::RosLog;
using sim::Wire;
using test::all_told;
using test::discarded_like;
using test::kMillisecond_ns;
using test::kRosStart;
using test::list_discarded;
using test::read_ros;
using test::small_drive;
using test::told;
using ::testing::HasSubstr;

// Bytes from there to the end of nav_msgs/Odometry: two covariances, six numbers of the twist, a quaternion.
constexpr std::size_t kTwist = (6 + 36) * sizeof(double);
constexpr std::size_t kOrientation = (4 + 36) * sizeof(double) + kTwist;
constexpr std::size_t kPosition = 3 * sizeof(double) + kOrientation;

/// Numbers of a little-endian message, so many bytes before its end.
void overwrite(std::string& bytes, std::size_t before_end, const std::vector<double>& numbers) {
  std::memcpy(bytes.data() + (bytes.size() - before_end), numbers.data(), numbers.size() * sizeof(double));
}

/// The small drive by odometry alone, whose messages were changed by their number.
template <typename Change>
RosLog odometry_log(Change change, Wire wire = Wire::cdr_little) {
  RosLog log = sim::ros_log(small_drive(), {.wire = wire, .joints = false});
  std::size_t k = 0;
  for (auto& message : log.messages)
    if (log.topics[message.topic].name == "/odom") change(message.bytes, k++);
  return log;
}

void forget_orientation(std::string& bytes, std::size_t) { overwrite(bytes, kOrientation, {0, 0, 0, 0}); }

/// The robot stays where it is and drives none the less.
void stay_at_origin(std::string& bytes, std::size_t) {
  overwrite(bytes, kPosition, {0, 0, 0, 0, 0, 0, 1});
  overwrite(bytes, kTwist, {0.5, 0, 0, 0, 0, 0.1});
}

/// How many there were, of a kind of which some were left out.
std::size_t all_of(const Recording& recording, const std::string& what) {
  for (const Discarded& one : recording.discarded)
    if (one.what == what) return one.of;
  return 0;
}

RosLog pose_log(bool rotations) {
  Recording drive = small_drive();
  drive.scans.clear();
  RosLog log = sim::ros_log(drive, {.wire = Wire::cdr_little});
  for (int k = 0; k < 20; ++k) {
    const std::int64_t time = kRosStart + 100 * kMillisecond_ns * k;
    std::string bytes = encode_pose(log.wire, {time, "map"}, {0.1 * k, 0.2, 0.3});
    if (!rotations || k < 5) overwrite(bytes, 4 * sizeof(double), {0, 0, 0, 0});
    log.add("/mocap", "geometry_msgs/PoseStamped", time, std::move(bytes));
  }
  return log;
}

TEST(RosPoses, without_a_rotation_are_counted_as_what_they_would_have_been) {
  for (const Wire wire : {Wire::ros1, Wire::cdr_little}) {
    const RosLog log = odometry_log(
        [](std::string& bytes, std::size_t k) {
          if (k % 10 < 4) overwrite(bytes, kOrientation, {0, 0, 1.5, 1});
        },
        wire);
    const auto found = value_of(read_ros(write_mcap(log)));
    EXPECT_EQ(found.odometry.size(), 120U);
    EXPECT_EQ(discarded_like(found, "odometry", "the orientation in /odom is no rotation"), 80U)
        << list_discarded(found);
    EXPECT_EQ(all_of(found, "odometry"), 200U);
  }
  const auto found = value_of(read_ros(write_mcap(pose_log(true))));
  EXPECT_EQ(found.poses.size(), 15U);
  EXPECT_EQ(discarded_like(found, "pose", "no rotation"), 5U) << list_discarded(found);
}

TEST(RosPoses, that_cannot_be_read_and_scans_are_counted_among_their_kind) {
  RosLog log = odometry_log([](std::string& bytes, std::size_t k) {
    if (k < 50) bytes.resize(20);
  });
  std::size_t scans = 0;
  for (auto& message : log.messages)
    if (log.topics[message.topic].name == "/scan" && scans++ < 3) message.bytes.resize(20);
  const auto found = value_of(read_ros(write_mcap(log)));
  EXPECT_EQ(discarded_like(found, "odometry", "/odom: does not hold what its type says"), 50U)
      << list_discarded(found);
  EXPECT_EQ(discarded_like(found, "scan", "/scan: does not hold what its type says"), 3U);
  EXPECT_EQ(all_of(found, "odometry"), 200U);
  EXPECT_EQ(all_of(found, "scan"), 40U);
}

/// Yaw written into z of the quaternion is one of length 1 near 0 only.
TEST(RosPoses, most_of_which_are_without_a_rotation_are_refused_for_that) {
  const RosLog log = odometry_log([](std::string& bytes, std::size_t k) {
    if (k % 10 < 6) overwrite(bytes, kOrientation, {0, 0, 1.5, 1});
  });
  const auto refused = read_ros(write_mcap(log));
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().text(), HasSubstr("the orientation in /odom is no rotation"));
  EXPECT_THAT(refused.error().text(), HasSubstr("in 120 of 200 messages; send z = sin(yaw / 2)"));
}

TEST(RosPoses, none_of_which_has_a_rotation_are_told_for_that) {
  for (const Wire wire : {Wire::ros1, Wire::cdr_little}) {
    const auto refused = read_ros(write_mcap(odometry_log(forget_orientation, wire)));
    ASSERT_FALSE(refused.ok());
    EXPECT_THAT(refused.error().text(), HasSubstr("the orientation in /odom is no rotation"));
    EXPECT_THAT(refused.error().text(), HasSubstr("in 200 of 200 messages"));
  }
  const auto found = value_of(read_ros(write_mcap(pose_log(false))));
  EXPECT_EQ(discarded_like(found, "pose", "no rotation"), 20U) << list_discarded(found);
  EXPECT_FALSE(told(found, "no topic with scans or poses")) << all_told(found.choices);
}

TEST(RosPoses, none_of_which_has_a_rotation_leave_the_choice_to_others) {
  RosLog log = odometry_log([](std::string&, std::size_t) {});
  std::string bytes = encode_odometry(log.wire, {kRosStart, "odom"}, "base_link", {0, 0, 0});
  forget_orientation(bytes, 0);
  log.add("/other_odom", "nav_msgs/Odometry", kRosStart, std::move(bytes));
  const auto found = value_of(read_ros(write_mcap(log)));
  EXPECT_EQ(found.odometry.size(), 200U);
  EXPECT_EQ(discarded_like(found, "message", "/other_odom was not taken"), 1U) << list_discarded(found);
}

TEST(RosPoses, that_never_change_while_the_twist_does_are_told) {
  for (const Wire wire : {Wire::ros1, Wire::cdr_little}) {
    const std::string bytes = write_mcap(odometry_log(stay_at_origin, wire));
    for (const TopicChoices& topics : {TopicChoices{}, TopicChoices{{"odometry", "/odom", {}}}}) {
      const auto refused = read_ros(bytes, topics);
      ASSERT_FALSE(refused.ok());
      EXPECT_THAT(refused.error().text(), HasSubstr("the pose in /odom never changes, its twist does"));
    }
  }
  EXPECT_FALSE(read_ros(write_mcap(odometry_log(stay_at_origin)), {{"pose", "/odom", {}}}).ok());
  const auto stood = read_ros(write_mcap(odometry_log([](std::string& bytes, std::size_t) {
    stay_at_origin(bytes, 0);
    overwrite(bytes, kTwist, {0, 0, 0, 0, 0, 0});
  })));
  EXPECT_TRUE(stood.ok()) << "whether the robot moved is asked later";
  const auto moved = read_ros(write_mcap(odometry_log([](std::string& bytes, std::size_t) {
    overwrite(bytes, kTwist, {0.5, 0, 0, 0, 0, 0});
  })));
  EXPECT_TRUE(moved.ok());
}

}  // namespace
}  // namespace odomcalib::ros_poses_test
