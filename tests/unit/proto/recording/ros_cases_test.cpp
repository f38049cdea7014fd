// Problems that people reported of ROS recordings, made small: the files are not part of the repository. Each
// kind is made anew in the tests beside this one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/proto/recording/ros_support.hpp"

namespace odomcalib::ros_cases_test {
namespace {

using test::all_told;
using test::told;
using ::testing::HasSubstr;

class RosCases : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto cases = test::shared_data().parent_path() / "cases";
    if (!std::filesystem::exists(cases))
      GTEST_SKIP() << "no cases: set ODOMCALIB_SHARED to the folder that holds cases/";
    folder_ = cases;
  }

  [[nodiscard]] Result<Recording> read(const std::string& name,
                                       const std::vector<std::string>& topics = {}) const {
    const RobotDescription robot{0.15, 0.15, 0.4, 0.0, std::nullopt, "", ""};
    TopicChoices choices;
    for (const auto& topic : topics) choices.push_back(value_of(parse_topic_choice(topic)));
    return read_recording(folder_ / (name + ".mcap.gz"), &robot, choices);
  }

  std::filesystem::path folder_;
};

/// s from the first to the last sample of the wheels
double duration(const Recording& recording) { return recording.ticks.back().t - recording.ticks.front().t; }

TEST_F(RosCases, four_wheels_are_told_apart_by_their_names_and_by_how_they_turn) {
  const auto straight = value_of(read("four-wheels-and-mecanum/no_strafing"));
  EXPECT_TRUE(told(straight, "joints back_left_wheel_joint (left) and back_right_wheel_joint (right)"));
  EXPECT_FALSE(told(straight, "turn otherwise")) << all_told(straight.choices);
  const std::string front = "wheels=/joint_states:front_left_wheel_joint,front_right_wheel_joint";
  EXPECT_TRUE(told(straight, "--topic " + front));
  EXPECT_TRUE(told(value_of(read("four-wheels-and-mecanum/strafing")), "turn otherwise"));
  EXPECT_TRUE(told(value_of(read("four-wheels-and-mecanum/strafing", {front})), "moves sideways"));
}

TEST_F(RosCases, of_a_car_the_rear_wheels_are_taken_and_the_front_ones_known_to_be_steered) {
  const auto car = value_of(read("steered-wheels/car"));
  EXPECT_TRUE(told(car, "joints rear_left_wheel_joint (left) and rear_right_wheel_joint (right)"));
  EXPECT_TRUE(told(car, "they are steered")) << all_told(car.choices);
}

TEST_F(RosCases, channels_without_a_schema_are_read_as_they_are_chosen) {
  const auto refused = read("mcap-without-schemas/no_schema");
  ASSERT_FALSE(refused.ok());
  EXPECT_THAT(refused.error().text(),
              HasSubstr("the file does not say what /joint_states and /scan are (no schema)"));
  const auto found = value_of(read("mcap-without-schemas/no_schema", {"scan=/scan", "wheels=/joint_states"}));
  EXPECT_EQ(found.wheels.size(), 250U);
  EXPECT_EQ(found.scans.size(), 29U);
}

TEST_F(RosCases, wheels_one_by_one_are_brought_to_one_instant) {
  for (const char* name : {"one-wheel-a-message/one_topic", "one-wheel-a-message/two_topics"}) {
    const auto found = value_of(read(name));
    EXPECT_GT(found.wheels.size(), 1900U);
    EXPECT_TRUE(told(found, "each sample has one wheel only")) << all_told(found.choices);
  }
}

TEST_F(RosCases, a_second_publisher_of_zeros_is_left_out) {
  const auto one = value_of(read("two-joint-state-publishers/one"));
  for (const char* name :
       {"two-joint-state-publishers/zeros_at_5_hz", "two-joint-state-publishers/zeros_at_25_hz"}) {
    const auto found = value_of(read(name));
    EXPECT_TRUE(told(found, "never change")) << all_told(found.choices);
    ASSERT_EQ(found.ticks.size(), one.ticks.size());
    EXPECT_EQ(found.ticks.back().left, one.ticks.back().left);
  }
  EXPECT_FALSE(told(one, "never change"));
}

TEST_F(RosCases, a_clock_that_was_set_meanwhile_makes_no_recording_of_54_years) {
  const auto found = value_of(read("boot-then-epoch/boot_then_epoch"));
  EXPECT_TRUE(told(found, "times of reception: the stamps of /joint_states jump by"))
      << all_told(found.choices);
  EXPECT_NEAR(duration(found), 77.0, 2.0);
}

TEST_F(RosCases, stamps_in_whole_seconds_give_way_to_the_times_of_reception) {
  for (const char* name :
       {"wheel-stamps-whole-seconds/joint_states", "wheel-stamps-whole-seconds/odometry"}) {
    const auto found = value_of(read(name));
    EXPECT_TRUE(told(found, "have lost their last digits")) << all_told(found.choices);
    EXPECT_GT(found.ticks.size(), 1900U);
  }
}

TEST_F(RosCases, two_lidars_on_one_topic_are_two_sensors) {
  const auto found = value_of(read("two-lidars-one-topic/half_turns"));
  EXPECT_TRUE(told(found, "/scan has scans of several frames: front_laser (")) << all_told(found.choices);
  for (const Scan& scan : found.scans)
    EXPECT_TRUE(scan.sensor == "front_laser" || scan.sensor == "rear_laser");
}

}  // namespace
}  // namespace odomcalib::ros_cases_test
