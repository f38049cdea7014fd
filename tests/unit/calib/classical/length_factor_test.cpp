// Patterns of ratios are told by their cause; lengths that are what they are called, and none of the
// patterns, are not.
#include "calib/classical/length_factor.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace odomcalib::calib::classical::length_factor_test {
namespace {

const RobotDescription kRobot{0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""};

std::string told(const LengthRatios& ratios, bool of_poses = false,
                 MotionSource motion = MotionSource::ticks) {
  const auto cause = cause_of_ratios(ratios, {kRobot, motion, of_poses});
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
  EXPECT_TRUE(holds(told({3.9, 3.95, 0.98}), "ticks_per_rev to 1024 instead of 4096"));
  EXPECT_TRUE(holds(told({1.0 / std::numbers::pi, 0.32, 1.0}), "circumference"));
  EXPECT_FALSE(holds(told({1.0 / std::numbers::pi, 0.32, 1.0}), "ticks_per_rev"));
  EXPECT_TRUE(holds(told({1.49, 1.52, 1.0}), "gear ratio"));
  EXPECT_TRUE(holds(told({0.06, 0.0601, 1.0}), "before a gear"));
  EXPECT_TRUE(holds(told({0.06, 0.0601, 1.0}), "ticks_per_rev to about 68200 instead of 4096: only as good"));
  EXPECT_TRUE(holds(told({1.25, 1.25, 1.0}), "1.25 times"));
}

TEST(LengthFactor, names_the_unit_of_all_lengths) {
  EXPECT_TRUE(holds(told({990.0, 985.0, 1010.0}), "in millimetres"));
  EXPECT_TRUE(holds(told({0.0255, 0.025, 0.0256}), "track_width are in inches"));
  EXPECT_TRUE(holds(told({990.0, 985.0, 1010.0}, true), "x and y of the poses by 0.001,"));
  EXPECT_TRUE(holds(told({2.0, 2.0, 2.0}), "not halved"));
  EXPECT_FALSE(holds(told({2.0, 2.0, 2.0}, true), "not halved")) << "poses have no way back";
  EXPECT_TRUE(holds(told({2.0, 2.0, 2.0}, true), "x and y of the poses"));
}

/// The unit is told by its name, with its factor, and nothing is said of counts that there are none of.
void expect_unit(MotionSource motion, const LengthRatios& ratios, const std::string& unit,
                 const std::string& remedy) {
  const std::string text = told(ratios, false, motion);
  EXPECT_TRUE(holds(text, "look like " + unit)) << text;
  EXPECT_TRUE(holds(text, "multiply them by " + remedy)) << text;
  EXPECT_FALSE(holds(text, "ticks_per_rev")) << text;
}

TEST(LengthFactor, names_the_unit_of_angles_and_speeds) {
  constexpr double kPi = std::numbers::pi;
  const auto wheels = [](double ratio) { return LengthRatios{ratio, 1.03 * ratio, 1.01}; };
  expect_unit(MotionSource::wheels, wheels(2.0 * kPi), "turns", "6.28319");
  expect_unit(MotionSource::wheels, wheels(kPi / 180.0), "degrees", "0.0174533");
  expect_unit(MotionSource::wheels, wheels(1.0 / 75.0), "millimetres at the rim", "0.0133333");
  expect_unit(MotionSource::wheel_speeds, wheels(kPi / 30.0), "rpm", "0.10472");
  expect_unit(MotionSource::wheel_speeds, wheels(kPi / 300.0), "rpm times 10", "0.010472");
  expect_unit(MotionSource::wheel_speeds, wheels(1.0 / 0.075), "metres per second", "13.3333");
  expect_unit(MotionSource::wheel_speeds, wheels(0.01 / 0.075), "centimetres per second", "0.133333");
}

TEST(LengthFactor, names_the_unit_of_odometry) {
  expect_unit(MotionSource::odometry, {0.01, 0.0101, 0.01}, "centimetres", "0.01");
  expect_unit(MotionSource::odometry, {0.001, 0.00102, 0.001}, "millimetres", "0.001");
  const std::string twice = told({0.5, 0.51, 0.5}, false, MotionSource::odometry);
  EXPECT_TRUE(holds(twice, "or x and y of the odometry are 1.99 times as long as they are")) << twice;
}

TEST(LengthFactor, speaks_of_a_gear_where_no_unit_fits) {
  const std::string text = told({1.0 / 30.0, 1.0 / 30.0, 1.0}, false, MotionSource::wheels);
  EXPECT_TRUE(holds(text, "motor before a gear")) << text;
  EXPECT_FALSE(holds(text, "ticks_per_rev")) << text;
  EXPECT_TRUE(holds(told({2.0, 2.0, 1.0}, false, MotionSource::wheels), "the radius was given as diameter"));
  EXPECT_EQ(told({1.1, 1.1, 1.0}, false, MotionSource::wheels), "") << "no unit is so near to rad";
}

TEST(LengthFactor, takes_angles_that_are_a_hundred_times_too_large_for_counts) {
  for (const MotionSource motion : {MotionSource::wheels, MotionSource::wheel_speeds}) {
    const std::string text = told({1.0 / 667.0, 1.0 / 667.0, 1.0}, false, motion);
    EXPECT_TRUE(holds(text, "encoder counts, some 4190 a turn")) << text;
    EXPECT_FALSE(holds(text, "gear")) << text;
    EXPECT_FALSE(holds(text, "set wheel_diameter")) << text;
  }
  EXPECT_TRUE(holds(told({1.0 / 30.0, 1.0 / 30.0, 1.0}, false, MotionSource::wheels), "before a gear"));
}

TEST(LengthFactor, names_the_track_alone_and_one_wheel_alone) {
  EXPECT_TRUE(holds(told({1.0, 1.0, 1.98}), "from the middle of the robot"));
  EXPECT_TRUE(holds(told({1.0, 1.0, 1.98}), "about 0.8 m"));
  EXPECT_TRUE(holds(told({1.0, 1.0, 0.34}), "track_width comes out 0.34 times")) << "by no known factor";
  EXPECT_EQ(told({1.0, 1.0, 0.7}), "");
  EXPECT_TRUE(holds(told({0.5, 0.99, 1.0}), "the left wheel diameter"));
  EXPECT_TRUE(holds(told({1.0, 3.9, 1.0}), "the right wheel diameter"));
}

}  // namespace
}  // namespace odomcalib::calib::classical::length_factor_test
