// Where the lidar sits, by /tf_static.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/proto/recording/ros_support.hpp"

namespace odomcalib::ros_mounting_test {
namespace {

using sim::RosLog;
using sim::RosTransform;
using sim::Wire;
using test::all_told;
using test::discarded;
using test::discarded_like;
using test::kRosStart;
using test::list_discarded;
using test::read_ros;
using test::small_log;
using test::told;

constexpr double kPi = std::numbers::pi;

std::array<double, 4> about_z(double yaw) { return {0.0, 0.0, std::sin(0.5 * yaw), std::cos(0.5 * yaw)}; }

RosTransform placed(const std::string& frame, const std::string& child, const std::array<double, 3>& position,
                    const std::array<double, 4>& quaternion = {0.0, 0.0, 0.0, 1.0}) {
  return {{kRosStart, frame}, child, position, quaternion};
}

RosLog with_frames(Wire wire, const std::vector<RosTransform>& transforms,
                   const std::string& topic = "/tf_static") {
  RosLog log = small_log(wire);
  log.add(topic, "tf2_msgs/TFMessage", kRosStart, encode_transforms(wire, transforms));
  return log;
}

/// base_footprint is the root; the lidar hangs on a mast of base_link that is turned by a quarter.
std::vector<RosTransform> frames(const std::array<double, 4>& lidar) {
  return {placed("base_footprint", "base_link", {0.0, 0.0, 0.1}),
          placed("base_link", "mast", {0.2, 0.1, 0.3}, about_z(0.5 * kPi)),
          placed("mast", "laser", {0.05, 0.0, 0.0}, lidar)};
}

TEST(RosMounting, is_the_chain_of_transforms_from_the_base_of_the_odometry) {
  for (const Wire wire : {Wire::ros1, Wire::cdr_little, Wire::cdr_big, Wire::cdr2_little}) {
    const auto found =
        value_of(read_ros(wire == Wire::ros1 ? write_bag(with_frames(wire, frames(about_z(0.25))))
                                             : write_mcap(with_frames(wire, frames(about_z(0.25))))));
    ASSERT_TRUE(found.robot.lidar_pose) << all_told(found.choices);
    EXPECT_NEAR((*found.robot.lidar_pose)[0], 0.2, 1e-12);
    EXPECT_NEAR((*found.robot.lidar_pose)[1], 0.15, 1e-12);
    EXPECT_NEAR((*found.robot.lidar_pose)[2], 0.5 * kPi + 0.25, 1e-12);
    EXPECT_TRUE(told(found, "lidar_pose = [0.200, 0.150, 1.8208] in base_link by /tf_static"))
        << all_told(found.choices);
  }
}

TEST(RosMounting, goes_up_and_down_where_base_and_lidar_hang_on_another_frame) {
  const auto found = value_of(read_ros(
      write_mcap(with_frames(Wire::cdr_little, {placed("chassis", "base_link", {0.1, 0.0, 0.0}, about_z(kPi)),
                                                placed("chassis", "laser", {0.3, 0.0, 0.2})}))));
  ASSERT_TRUE(found.robot.lidar_pose);
  EXPECT_NEAR((*found.robot.lidar_pose)[0], -0.2, 1e-12);
  EXPECT_NEAR(std::abs((*found.robot.lidar_pose)[2]), kPi, 1e-12);
}

TEST(RosMounting, of_a_lidar_that_hangs_upside_down_is_not_taken) {
  const auto found =
      value_of(read_ros(write_mcap(with_frames(Wire::cdr_little, frames({1.0, 0.0, 0.0, 0.0})))));
  EXPECT_FALSE(found.robot.lidar_pose);
  EXPECT_TRUE(told(found, "upside down")) << all_told(found.choices);
}

TEST(RosMounting, without_a_chain_is_said) {
  const auto found =
      value_of(read_ros(write_mcap(with_frames(Wire::cdr_little, {placed("map", "odom", {})}))));
  EXPECT_FALSE(found.robot.lidar_pose);
  EXPECT_TRUE(told(found, "/tf_static does not lead from the base to the lidar's frame laser"))
      << all_told(found.choices);
  const auto ring = value_of(read_ros(
      write_mcap(with_frames(Wire::cdr_little, {placed("a", "laser", {}), placed("laser", "a", {})}))));
  EXPECT_FALSE(ring.robot.lidar_pose) << "a ring of transforms ends";
}

TEST(RosMounting, is_not_taken_of_frames_that_move) {
  const auto found =
      value_of(read_ros(write_mcap(with_frames(Wire::cdr_little, frames(about_z(0.0)), "/tf"))));
  EXPECT_FALSE(found.robot.lidar_pose);
}

TEST(RosMounting, with_places_that_are_no_numbers_is_none) {
  for (const double wrong : {std::nan(""), HUGE_VAL, 1e308}) {
    auto far = frames(about_z(0.0));
    far[0].position = far[1].position = far[2].position = {wrong, wrong, wrong};
    EXPECT_FALSE(value_of(read_ros(write_mcap(with_frames(Wire::cdr_little, far)))).robot.lidar_pose)
        << wrong;
  }
}

TEST(RosMounting, of_a_damaged_message_is_none) {
  RosLog log = small_log(Wire::cdr_little);
  log.add("/tf_static", "tf2_msgs/TFMessage", kRosStart,
          encode_transforms(log.wire, frames({0.0, 0.0, 0.0, 0.0})));
  log.add("/tf_static", "tf2_msgs/TFMessage", kRosStart, std::string("\0\1\0\0\xff\xff\xff\xff", 8));
  EXPECT_FALSE(value_of(read_ros(write_mcap(log))).robot.lidar_pose);
}

/// A bag with a description, and maybe with frames.
RosLog with_description(Wire wire, const std::string& urdf, const std::vector<RosTransform>& transforms = {},
                        const std::string& topic = "/robot_description") {
  RosLog log = transforms.empty() ? small_log(wire) : with_frames(wire, transforms);
  log.add(topic, "std_msgs/String", kRosStart, encode_text(wire, urdf));
  return log;
}

/// The lidar hangs on a mast that is turned by a quarter; wheels turn, and lead nowhere.
std::string urdf_of(const std::string& type_of_mast, const std::string& rpy = "0 0 1.5707963267948966") {
  return R"(<?xml version="1.0"?><!-- of a shop --><robot name="r"><link name="base_link"/><link name="mast"/>
<joint name="wheel" type="continuous"><parent link="base_link"/><child link="wheel"/><origin xyz="0 0.2 0"/></joint>
<joint name="to_mast" type=")" +
         type_of_mast + R"("><origin xyz="0.2  0.1
0.3" rpy=")" +
         rpy + R"("/><parent link="base_link"/><child link="mast"/></joint>
<joint name="to_laser" type="fixed"><parent link="mast"/><child link="laser"/><origin xyz="5e-2 0 0" rpy="0 0 .25"/></joint>
</robot>)";
}

TEST(RosMounting, is_told_by_the_description_where_no_frames_are_published) {
  for (const Wire wire : {Wire::ros1, Wire::cdr_little, Wire::cdr_big}) {
    const RosLog log = with_description(wire, urdf_of("fixed"));
    const auto found = value_of(read_ros(wire == Wire::ros1 ? write_bag(log) : write_mcap(log)));
    ASSERT_TRUE(found.robot.lidar_pose) << all_told(found.choices);
    EXPECT_NEAR((*found.robot.lidar_pose)[0], 0.2, 1e-9);
    EXPECT_NEAR((*found.robot.lidar_pose)[1], 0.15, 1e-9);
    EXPECT_NEAR((*found.robot.lidar_pose)[2], 0.5 * kPi + 0.25, 1e-9);
    EXPECT_TRUE(told(found, "lidar_pose = [0.200, 0.150, 1.8208] in base_link by /robot_description"))
        << all_told(found.choices);
  }
}

TEST(RosMounting, of_published_frames_goes_before_the_description) {
  const auto found = value_of(read_ros(write_mcap(with_description(
      Wire::cdr_little, urdf_of("fixed"), {placed("base_link", "laser", {0.4, 0.0, 0.0})}))));
  ASSERT_TRUE(found.robot.lidar_pose);
  EXPECT_EQ((*found.robot.lidar_pose)[0], 0.4);
  const auto both = value_of(read_ros(write_mcap(
      with_description(Wire::cdr_little, urdf_of("fixed"), {placed("base_footprint", "base_link", {})}))));
  EXPECT_TRUE(told(both, "by /robot_description and /tf_static")) << all_told(both.choices);
}

TEST(RosMounting, by_a_description_that_moves_or_is_none_is_none) {
  for (const std::string& urdf :
       {urdf_of("revolute"), urdf_of("fixed", "0 0 north"), urdf_of("fixed", "0 0 nan"),
        urdf_of("fixed", "0 0"), urdf_of("fixed").substr(0, 300),
        std::string("<robot><joint type='fixed'/></robot>"), std::string(100000, '<'), std::string()}) {
    const auto found = value_of(read_ros(write_mcap(with_description(Wire::cdr_little, urdf))));
    EXPECT_FALSE(found.robot.lidar_pose) << urdf.substr(0, 400);
  }
  std::string deep = "<robot>";
  for (int k = 0; k < 50000; ++k) deep += "<joint>";
  EXPECT_FALSE(value_of(read_ros(write_mcap(with_description(Wire::cdr_little, deep)))).robot.lidar_pose);
  const auto upside_down = value_of(
      read_ros(write_mcap(with_description(Wire::cdr_little, urdf_of("fixed", "3.141592653589793 0 0")))));
  EXPECT_TRUE(told(upside_down, "upside down")) << all_told(upside_down.choices);
  const auto elsewhere =
      value_of(read_ros(write_mcap(with_description(Wire::cdr_little, urdf_of("fixed"), {}, "/news"))));
  EXPECT_FALSE(elsewhere.robot.lidar_pose);
}

TEST(RosMounting, loses_a_transform_that_is_none_and_no_other) {
  for (const auto& [position, quaternion] :
       std::vector<std::pair<std::array<double, 3>, std::array<double, 4>>>{
           {{}, {}}, {{}, {0.0, 0.0, 0.0, std::nan("")}}, {{0.0, HUGE_VAL, 0.0}, {0.0, 0.0, 0.0, 1.0}}}) {
    auto placed_frames = frames(about_z(0.25));
    placed_frames.insert(placed_frames.begin() + 1, placed("base_link", "camera", position, quaternion));
    const auto found = value_of(read_ros(write_mcap(with_frames(Wire::cdr_little, placed_frames))));
    ASSERT_TRUE(found.robot.lidar_pose) << all_told(found.choices);
    EXPECT_NEAR((*found.robot.lidar_pose)[1], 0.15, 1e-12);
    EXPECT_EQ(discarded(found, "transform", "/tf_static: position or rotation missing or impossible"), 1U)
        << list_discarded(found);
    EXPECT_EQ(discarded_like(found, "message", "/tf_static"), 0U) << list_discarded(found);
  }
  std::string urdf = urdf_of("fixed");
  urdf.insert(urdf.find("</robot>"),
              R"(<joint name="c" type="fixed"><parent link="base_link"/><child link="camera"/>)"
              R"(<origin xyz="0 0 high"/></joint><joint name="d" type="fixed"><child link="lamp"/></joint>)");
  const auto found = value_of(read_ros(write_mcap(with_description(Wire::cdr_little, urdf))));
  ASSERT_TRUE(found.robot.lidar_pose) << all_told(found.choices);
  EXPECT_EQ(discarded(found, "transform", "/robot_description: position or rotation missing or impossible"),
            2U)
      << list_discarded(found);
}

TEST(RosMounting, of_messages_that_cannot_be_read_is_counted_and_what_came_before_stays) {
  RosLog log =
      with_description(Wire::cdr_little, urdf_of("fixed"), {placed("base_footprint", "base_link", {})});
  log.add("/tf_static", "tf2_msgs/TFMessage", kRosStart, std::string("\0\1\0\0\xff\xff\xff\xff", 8));
  for (const std::string& text :
       {urdf_of("fixed").substr(0, 300), std::string("no robot"), std::string(), std::string("<html/>")})
    log.add("/robot_description", "std_msgs/String", kRosStart, encode_text(log.wire, text));
  log.add("/robot_description", "std_msgs/String", kRosStart, std::string("\0\1\0\0\xff\xff\xff\xff", 8));
  const auto found = value_of(read_ros(write_mcap(log)));
  EXPECT_TRUE(found.robot.lidar_pose) << all_told(found.choices);
  EXPECT_EQ(discarded(found, "message", "/tf_static: does not hold what its type says"), 1U)
      << list_discarded(found);
  EXPECT_EQ(discarded(found, "message", "/robot_description: does not hold what its type says"), 5U)
      << list_discarded(found);
}

}  // namespace
}  // namespace odomcalib::ros_mounting_test
