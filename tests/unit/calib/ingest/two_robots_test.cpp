// Statements of several recordings about their robot.
#include "calib/ingest/recording_check.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace odomcalib::calib::ingest::two_robots_test {
namespace {

Recording recording_of(const std::string& name, const std::string& robot_id) {
  Recording recording;
  recording.name = name;
  recording.robot.robot_id = robot_id;
  recording.robot.left_wheel_diameter = recording.robot.right_wheel_diameter = 0.15;
  recording.robot.track_width = 0.4;
  recording.robot.ticks_per_rev = 4096.0;
  return recording;
}

TEST(TwoRobots, are_told_by_their_names) {
  const std::vector<Recording> recordings = {recording_of("a", "red"), recording_of("b", ""),
                                             recording_of("c", "blue")};
  const auto error = two_robots(recordings, false);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code, ErrorCode::refused);
  EXPECT_EQ(error->where, "c");
  EXPECT_EQ(error->what, "is of robot \"blue\", but a of \"red\"");
  EXPECT_FALSE(two_robots(recordings, true)) << "somebody knows better";
}

TEST(TwoRobots, are_none_where_only_one_has_a_name) {
  const std::vector<Recording> recordings = {recording_of("a", ""), recording_of("b", "red"),
                                             recording_of("c", "red")};
  EXPECT_FALSE(two_robots(recordings, false));
}

TEST(TwoRobots, are_told_by_every_nominal_size_whatever_they_are_called) {
  for (double RobotDescription::*size :
       {&RobotDescription::left_wheel_diameter, &RobotDescription::right_wheel_diameter,
        &RobotDescription::track_width, &RobotDescription::ticks_per_rev}) {
    std::vector<Recording> recordings = {recording_of("a", "red"), recording_of("b", "blue")};
    recordings[1].robot.*size *= 2.0;
    for (const bool same_robot : {false, true}) {
      const auto error = two_robots(recordings, same_robot);
      ASSERT_TRUE(error);
      EXPECT_EQ(error->code, ErrorCode::format);
      EXPECT_EQ(error->where, "b");
    }
  }
}

}  // namespace
}  // namespace odomcalib::calib::ingest::two_robots_test
