// The robot's nominal geometry: a file of its own or the daemon's configuration, and errors that name the key
// that works.
#include "daemon/config/robot_file.hpp"

#include <gtest/gtest.h>

#include "proto/near_miss.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::robot_file_test {
namespace {

const std::string kDaemon = R"([controller]
device = "socketcan:can0"
profile = "zlac8015d.toml"
[lidar]
device = "serial:/dev/ttyUSB0?baud=230400"
pose = [0.1, 0.02, 0.5]
[robot]
id = "robot-1"
wheel_diameter = 0.15
right_wheel_diameter = 0.149
track_width = 0.4
front = 0.25
back = 0.25
width = 0.5
[limits]
speed = 0.3
)";

std::string error_of(const std::string& text) {
  const auto robot = parse_robot_file(text, "robot.toml");
  return robot.ok() ? "" : robot.error().text();
}

/// The error names the file, the wrong key, and `meant`.
void expect_names(const std::string& text, const std::string& wrong, const std::string& meant) {
  const std::string error = error_of(text);
  EXPECT_NE(error.find("robot.toml"), std::string::npos) << error;
  EXPECT_NE(error.find("\"" + wrong + "\""), std::string::npos) << error;
  EXPECT_NE(error.find(meant), std::string::npos) << error;
}

TEST(RobotFile, states_dimensions_and_pose) {
  const auto robot = value_of(parse_robot_file(
      "wheel_diameter = 0.15\nright_wheel_diameter = 0.149\ntrack_width = 0.4\nticks_per_rev = 4096\n"
      "lidar_pose = [0.1, 0, 0.5]\nrobot_id = \"a\"\n",
      "robot.toml"));
  EXPECT_EQ(robot.left_wheel_diameter, 0.15);
  EXPECT_EQ(robot.right_wheel_diameter, 0.149);
  EXPECT_EQ(robot.track_width, 0.4);
  EXPECT_EQ(robot.ticks_per_rev, 4096.0);
  EXPECT_EQ((*robot.lidar_pose)[2], 0.5);
  EXPECT_EQ(robot.robot_id, "a");
}

TEST(RobotFile, may_be_the_configuration_of_the_daemon) {
  const auto robot = value_of(parse_robot_file(kDaemon, "odomcalib.toml"));
  EXPECT_EQ(robot.left_wheel_diameter, 0.15);
  EXPECT_EQ(robot.right_wheel_diameter, 0.149);
  EXPECT_EQ(robot.track_width, 0.4);
  EXPECT_EQ((*robot.lidar_pose)[1], 0.02);
  EXPECT_EQ(robot.robot_id, "robot-1");
  EXPECT_EQ(robot.ticks_per_rev, 0.0) << "the recording's";
}

TEST(RobotFile, that_is_shipped_as_the_configuration_is_read) {
  const auto robot = value_of(read_robot_file("systemd/odomcalib.toml"));
  EXPECT_EQ(robot.track_width, 0.4);
  EXPECT_TRUE(robot.lidar_pose.has_value());
}

TEST(RobotFile, with_a_section_may_hold_what_a_configuration_lacks) {
  const auto robot =
      value_of(parse_robot_file("[robot]\nticks_per_rev = 4096\nlidar_pose = [0.1, 0, 0]\n", "robot.toml"));
  EXPECT_EQ(robot.ticks_per_rev, 4096.0);
  EXPECT_EQ((*robot.lidar_pose)[0], 0.1);
}

TEST(RobotFile, misspelt_names_the_key_that_would_work) {
  expect_names("track_widht = 0.4\n", "track_widht", "did you mean \"track_width\"?");
  expect_names("wheel_diametre = 0.15\n", "wheel_diametre", "did you mean \"wheel_diameter\"?");
  expect_names("lidarpose = [0, 0, 0]\n", "lidarpose", "did you mean \"lidar_pose\"?");
  expect_names("[robot]\ntrak_width = 0.4\n", "robot.trak_width", "did you mean \"robot.track_width\"?");
  expect_names("track_width = 0.4\n[robot]\nwheel_diameter = 0.15\n", "track_width",
               "did you mean \"robot.track_width\"?");
}

TEST(RobotFile, in_the_words_of_others_is_translated) {
  expect_names("wheel_radius = 0.075\n", "wheel_radius", "write wheel_diameter, which is twice the radius");
  expect_names("wheel_separation = 0.4\n", "wheel_separation", "write track_width");
  expect_names("[robot]\nticks_per_revolution = 4096\n", "robot.ticks_per_revolution", "write ticks_per_rev");
}

TEST(RobotFile, of_another_format_says_how_the_line_is_written_here) {
  const auto says = [](const char* text, const char* words) {
    const std::string error = error_of(text);
    EXPECT_NE(error.find(words), std::string::npos) << error;
  };
  says("wheel_diameter: 0.15\n", "this is YAML; write TOML: wheel_diameter = 0.15");
  says("track_width = 0.4\nwheel_diameter = 0,15\n", "write a decimal point: wheel_diameter = 0.15");
  says("track_width = 0.4 m\n", "correct the TOML syntax");
  says("wheel_diameter = 150\n", "150 looks like mm: write 0.15");
  says("lidar_pose = [100, 0, 0]\n", "100 looks like mm: write 0.1");
  says("lidar_pose = [0.1, 0, 90]\n", "90 looks like degrees: write 1.5708");
  EXPECT_EQ(error_of("wheel_diameter = 150000\n").find("looks like"), std::string::npos);
}

TEST(RobotFile, with_a_word_that_is_near_to_nothing_points_to_the_page) {
  const std::string error = error_of("colour = \"red\"\n");
  EXPECT_EQ(error.find("did you mean"), std::string::npos) << error;
  EXPECT_NE(error.find("odomcalib-robot.toml(5)"), std::string::npos) << error;
}

TEST(RobotFile, with_a_value_out_of_range_or_of_another_type_says_what_is_allowed) {
  expect_names("track_width = 400\n", "track_width", "a number from 0.001 to 10");
  expect_names("track_width = \"0.4\"\n", "track_width", "a number");
  expect_names("lidar_pose = [0.1, 0]\n", "lidar_pose", "three numbers");
}

TEST(RobotFile, without_any_key_is_refused) {
  EXPECT_NE(error_of("").find("states nothing"), std::string::npos);
  EXPECT_NE(error_of("[robot]\nfront = 0.25\n").find("states nothing"), std::string::npos);
}

TEST(NearMiss, is_at_most_a_third_of_the_letters_away) {
  const std::set<std::string> known = {"lidar.pose", "robot.track_width", "track_width"};
  EXPECT_EQ(near_miss("trackwidth", known), "track_width");
  EXPECT_EQ(near_miss("pose", known), "lidar.pose");
  EXPECT_EQ(near_miss("lidr.device", {"controller.device", "lidar.device"}), "lidar.device");
  EXPECT_EQ(near_miss("contrller.device", {"controller.device", "lidar.device"}), "controller.device");
  EXPECT_EQ(near_miss("tracks", known), std::nullopt);
  EXPECT_EQ(near_miss("track", known), "track_width");
  EXPECT_EQ(near_miss("", known), std::nullopt);
  EXPECT_EQ(near_miss(std::string(100000, 'a'), known), std::nullopt);
}

}  // namespace
}  // namespace odomcalib::robot_file_test
