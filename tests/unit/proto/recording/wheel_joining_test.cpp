// Wheels that are told one by one.
#include "proto/recording/wheel_joining.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "tests/unit/proto/support.hpp"

namespace odomcalib::wheel_joining_test {
namespace {

using test::read_text;
using ::testing::HasSubstr;

/// The left wheel every 20 ms, the right one `late` s after it.
struct Wheels {
  std::vector<SideSample> left, right;
};
Wheels wheels(double late, double right_interval = 0.02) {
  Wheels out;
  for (int k = 0; k < 100; ++k) out.left.push_back({0.02 * k, 3.0 * 0.02 * k});
  for (int k = 0; right_interval * k < 2.0; ++k) {
    const double t = right_interval * k + late;
    out.right.push_back({t, 4.0 * t});
  }
  return out;
}

TEST(WheelJoining, brings_the_finer_wheel_to_the_times_of_the_other) {
  const Wheels same = wheels(0.007);
  auto joined = joined_wheels(same.left, same.right, Between::linear);
  EXPECT_EQ(joined.kept, Side::left);
  EXPECT_EQ(joined.alone, 1U);
  ASSERT_EQ(joined.wheels.size(), 99U);
  for (const WheelSample& one : joined.wheels) EXPECT_NEAR(one.right, 4.0 * one.t, 1e-12);
  const Wheels coarse = wheels(0.007, 0.05);
  joined = joined_wheels(coarse.left, coarse.right, Between::linear);
  EXPECT_EQ(joined.kept, Side::right);
  for (const WheelSample& one : joined.wheels) EXPECT_NEAR(one.left, 3.0 * one.t, 1e-12);
}

TEST(WheelJoining, goes_not_between_samples_that_lie_far_apart) {
  Wheels gap = wheels(0.007);
  gap.left.resize(75);
  std::erase_if(gap.right, [](const SideSample& one) { return one.t > 0.5 && one.t < 0.7; });
  const auto joined = joined_wheels(gap.left, gap.right, Between::linear);
  for (const WheelSample& one : joined.wheels) EXPECT_FALSE(one.t > 0.5 && one.t < 0.68) << one.t;
  EXPECT_GT(joined.alone, 8U);
  // One that got lost is bridged.
  Wheels lost = wheels(0.007);
  lost.right.erase(lost.right.begin() + 30);
  EXPECT_EQ(joined_wheels(lost.left, lost.right, Between::linear).alone, 1U);
}

TEST(WheelJoining, continues_angles_of_one_turn_before_it_goes_between_them) {
  Wheels turning = wheels(0.007);
  for (SideSample& one : turning.right) one.value = std::remainder(one.value, 2.0 * std::numbers::pi);
  const auto joined = joined_wheels(turning.left, turning.right, Between::linear);
  const double offset = joined.wheels.front().right - 4.0 * joined.wheels.front().t;
  for (const WheelSample& one : joined.wheels) EXPECT_NEAR(one.right, 4.0 * one.t + offset, 1e-9);
}

TEST(WheelJoining, holds_speeds) {
  const std::vector<SideSample> left{{0.0, 1.0}, {0.1, 1.5}, {0.2, 2.0}},
      right{{0.05, 5.0}, {0.15, 6.0}, {0.25, 7.0}};
  const auto joined = joined_wheels(left, right, Between::held);
  ASSERT_EQ(joined.wheels.size(), 2U);
  EXPECT_EQ(joined.wheels[0].right, 5.0);
  EXPECT_EQ(joined.wheels[1].right, 6.0);
}

std::string half(const std::string& type, double t, const std::string& side, double value) {
  std::ostringstream out;
  out.precision(17);
  out << R"({"type":")" << type << R"(","t":)" << t << R"(,")" << side << R"(":)" << value << "}\n";
  return out.str();
}

std::string halves(const std::string& type) {
  std::string text = test::kRobotLine;
  for (int k = 0; k < 100; ++k)
    text += half(type, 0.02 * k, "left", 0.06 * k) + half(type, 0.02 * k + 0.01, "right", 0.08 * k + 0.04);
  return text;
}

TEST(WheelJoining, takes_lines_with_one_wheel_each) {
  const Recording angles = value_of(read_text(halves("wheels")));
  ASSERT_EQ(angles.wheels.size(), 99U);
  for (const WheelSample& one : angles.wheels) EXPECT_NEAR(one.right, 4.0 * one.t, 1e-12);
  EXPECT_THAT(angles.choices.front(), HasSubstr("each sample has one wheel only (100 left, 100 right)"));
  EXPECT_EQ(value_of(read_text(halves("wheel_speeds"))).wheel_speeds.size(), 99U);
}

TEST(WheelJoining, takes_a_wheel_alone_among_lines_with_both_as_a_broken_line) {
  std::string text = test::kRobotLine;
  for (int k = 0; k < 10; ++k)
    text += R"({"type":"wheels","t":)" + std::to_string(0.1 * k) + R"(,"left":0.5,"right":0.25})" + "\n";
  const Recording found = value_of(read_text(text + half("wheels", 0.55, "left", 9.0)));
  EXPECT_EQ(found.wheels.size(), 10U);
  EXPECT_EQ(test::discarded(found, "wheels", "left or right missing or not an angle"), 1U);
  ASSERT_EQ(found.choices.size(), 1U);
}

TEST(WheelJoining, refuses_one_wheel_without_the_other) {
  std::string text = test::kRobotLine;
  for (int k = 0; k < 10; ++k) text += half("wheels", 0.1 * k, "left", 0.1 * k);
  const auto result = read_text(text);
  ASSERT_FALSE(result.ok());
  EXPECT_THAT(result.error().text(), HasSubstr("10 x wheels left out, left or right missing"));
}

TEST(WheelJoining, says_which_wheel_is_missing_where_scans_are_there) {
  const std::string robot = R"({"type":"robot","wheel_diameter":0.154,"track_width":0.33})"
                            "\n";
  const std::string scan = R"({"type":"scan","t":0.1,"angle_min":0,"angle_increment":0.1,"ranges":[1,2]})"
                           "\n";
  for (const std::string type : {"wheels", "wheel_speeds"})
    for (const std::string other : {"", R"(,"left":null)"}) {
      std::string text = robot + scan;
      for (int k = 0; k < 10; ++k)
        text +=
            R"({"type":")" + type + R"(","t":)" + std::to_string(0.1 * k) + R"(,"right":0.5)" + other + "}\n";
      const auto result = read_text(text);
      ASSERT_FALSE(result.ok());
      EXPECT_THAT(result.error().text(),
                  HasSubstr("10 " + type + " lines have the right wheel, and none has the left one"));
    }
  // Null stands for the wheel that the line does not have.
  std::string text = robot;
  for (int k = 0; k < 100; ++k) {
    text += half("wheels", 0.02 * k, "left", 0.06 * k);
    text.insert(text.size() - 2, R"(,"right":null)");
    text += half("wheels", 0.02 * k + 0.01, "right", 0.08 * k + 0.04);
    text.insert(text.size() - 2, R"(,"left":null)");
  }
  EXPECT_EQ(value_of(read_text(text)).wheels.size(), 99U);
}

}  // namespace
}  // namespace odomcalib::wheel_joining_test
