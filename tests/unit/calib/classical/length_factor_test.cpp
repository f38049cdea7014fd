// Patterns of ratios are told by their cause; lengths that are what they are called, and none of the
// patterns, are not.
#include "calib/classical/length_factor.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace odomcalib::calib::classical::length_factor_test {
namespace {

const RobotDescription kRobot{0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""};

std::string told(const LengthRatios& ratios, bool of_poses = false) {
  const auto cause = cause_of_ratios(ratios, kRobot, of_poses);
  return cause ? cause->what + "; " + cause->remedy : "";
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(LengthFactor, names_nothing_where_lengths_are_near_their_nominal_values) {
  EXPECT_EQ(told({1.0, 1.0, 1.0}), "");
  EXPECT_EQ(told({1.15, 1.12, 0.9}), "");
  EXPECT_EQ(told({0.98, 1.01, 1.67}), "") << "the track of a tracked robot is no factor";
}

TEST(LengthFactor, names_nothing_where_ratios_make_no_pattern) {
  EXPECT_EQ(told({2.0, 4.0, 1.0}), "");
  EXPECT_EQ(told({2.0, 2.0, 5.0}), "");
  EXPECT_EQ(told({1.3, 1.0, 1.0}), "") << "a wheel of another size";
  EXPECT_EQ(told({-1.0, -1.0, -1.0}), "");
}

TEST(LengthFactor, names_counts_and_diameters_by_their_factor) {
  EXPECT_TRUE(holds(told({2.02, 1.97, 1.01}), "the radius was given"));
  EXPECT_TRUE(holds(told({3.9, 3.95, 0.98}), "all four edges"));
  EXPECT_TRUE(holds(told({3.9, 3.95, 0.98}), "ticks_per_rev to about 1043"));
  EXPECT_TRUE(holds(told({1.0 / std::numbers::pi, 0.32, 1.0}), "circumference"));
  EXPECT_TRUE(holds(told({1.49, 1.52, 1.0}), "gear ratio"));
  EXPECT_TRUE(holds(told({0.06, 0.0601, 1.0}), "before a gear"));
  EXPECT_TRUE(holds(told({1.25, 1.25, 1.0}), "1.25 times"));
}

TEST(LengthFactor, names_the_unit_of_all_lengths) {
  EXPECT_TRUE(holds(told({990.0, 985.0, 1010.0}), "in millimetres"));
  EXPECT_TRUE(holds(told({0.0255, 0.025, 0.0256}), "track_width are in inches"));
  EXPECT_TRUE(holds(told({2.0, 2.0, 2.0}), "not halved"));
  EXPECT_FALSE(holds(told({2.0, 2.0, 2.0}, true), "not halved")) << "poses have no way back";
  EXPECT_TRUE(holds(told({2.0, 2.0, 2.0}, true), "x and y of the poses"));
}

TEST(LengthFactor, names_the_track_alone_and_one_wheel_alone) {
  EXPECT_TRUE(holds(told({1.0, 1.0, 1.98}), "from the middle of the robot"));
  EXPECT_TRUE(holds(told({1.0, 1.0, 1.98}), "about 0.792 m"));
  EXPECT_TRUE(holds(told({0.5, 0.99, 1.0}), "the left wheel diameter"));
  EXPECT_TRUE(holds(told({1.0, 3.9, 1.0}), "the right wheel diameter"));
}

}  // namespace
}  // namespace odomcalib::calib::classical::length_factor_test
