// Recordings that tell the motion of the wheels without counting.
#include "proto/recording/wheel_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/proto/support.hpp"

namespace odomcalib::wheel_motion_test {
namespace {

using test::discarded;
using test::list_discarded;
using test::read_text;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kTicksPerRev = 2000.0;
constexpr double kFineCount = kTurn / kFineCountsPerRev;
constexpr const char* kRobotWithoutTicks = R"({"type":"robot","wheel_diameter":0.15,"track_width":0.4})"
                                           "\n";
constexpr const char* kRobotWithTicks =
    R"({"type":"robot","wheel_diameter":0.15,"track_width":0.4,"ticks_per_rev":2000})"
    "\n";

std::string number(double value) {
  std::ostringstream out;
  out.precision(17);
  out << value;
  return out.str();
}

std::string line(const std::string& type, double t, double left, double right) {
  return R"({"type":")" + type + R"(","t":)" + number(t) + R"(,"left":)" + number(left) + R"(,"right":)" +
         number(right) + "}\n";
}

std::string odometry_line(double t, double x, double y, double yaw) {
  return R"({"type":"odometry","t":)" + number(t) + R"(,"x":)" + number(x) + R"(,"y":)" + number(y) +
         R"(,"yaw":)" + number(yaw) + "}\n";
}

/// Counts of a robot that sets off, bends left and right, and stops.
std::vector<TickSample> drive() {
  std::vector<TickSample> ticks;
  double left = 0.0, right = 0.0;
  for (int k = 0; k < 500; ++k) {
    const double speed = 30.0 * std::sin(std::numbers::pi * k / 500.0);
    left += speed * (1.0 + 0.3 * std::sin(0.02 * k));
    right += speed * (1.0 - 0.3 * std::sin(0.02 * k));
    ticks.push_back({0.02 * k, std::llround(left), std::llround(right), 0});
  }
  return ticks;
}

double angle(std::int64_t count, double per_rev = kTicksPerRev) {
  return kTurn * static_cast<double>(count) / per_rev;
}

void expect_same_motion(const Recording& found, const std::vector<TickSample>& counted, double tolerance) {
  ASSERT_EQ(found.ticks.size(), counted.size()) << list_discarded(found);
  for (std::size_t i = 0; i < counted.size(); ++i) {
    const TickSample& sample = found.ticks[i];
    EXPECT_EQ(sample.t, counted[i].t);
    EXPECT_EQ(sample.segment, 0);
    EXPECT_NEAR(angle(sample.left - found.ticks[0].left, found.robot.ticks_per_rev),
                angle(counted[i].left - counted[0].left), tolerance);
    EXPECT_NEAR(angle(sample.right - found.ticks[0].right, found.robot.ticks_per_rev),
                angle(counted[i].right - counted[0].right), tolerance);
  }
}

TEST(WheelMotion, angles_on_the_encoders_grid_give_the_encoders_counts) {
  std::string text = kRobotWithTicks;
  for (const TickSample& s : drive()) text += line("wheels", s.t, angle(s.left), angle(s.right));
  const Recording r = value_of(read_text(text));
  EXPECT_EQ(r.motion, MotionSource::wheels);
  EXPECT_EQ(r.robot.ticks_per_rev, kTicksPerRev);
  const auto counted = drive();
  for (std::size_t i = 0; i < counted.size(); ++i) {
    EXPECT_EQ(r.ticks[i].left, counted[i].left);
    EXPECT_EQ(r.ticks[i].right, counted[i].right);
  }
  EXPECT_EQ(r.choices, std::vector<std::string>{"wheel motion from wheels"});
}

TEST(WheelMotion, angles_off_the_grid_are_kept_finely_whatever_resolution_is_stated) {
  constexpr double kOff = 1e-3;  // rad, a third of a count
  for (const char* robot : {kRobotWithoutTicks, kRobotWithTicks}) {
    std::string text = robot;
    for (const TickSample& s : drive())
      text += line("wheels", s.t, angle(s.left) + kOff * std::sin(s.t), angle(s.right));
    const auto result = value_of(read_text(text));
    EXPECT_EQ(result.robot.ticks_per_rev, kFineCountsPerRev);
    expect_same_motion(result, drive(), kOff + kFineCount);
    for (std::size_t i = 0; i < result.ticks.size(); ++i)
      EXPECT_NEAR(angle(result.ticks[i].left, kFineCountsPerRev), result.wheels[i].left, kFineCount);
  }
}

TEST(WheelMotion, angles_kept_within_a_turn_are_continued) {
  for (const double lowest : {0.0, -std::numbers::pi}) {
    std::string text = kRobotWithTicks;
    const auto within = [&](std::int64_t count) {
      const double turns = (angle(count) - lowest) / kTurn;
      return lowest + kTurn * (turns - std::floor(turns));
    };
    for (const TickSample& s : drive()) text += line("wheels", s.t, within(s.left), within(s.right));
    const auto result = value_of(read_text(text));
    expect_same_motion(result, drive(), 1e-9);
  }
}

TEST(WheelMotion, S3_17_speeds_in_radians_a_second_are_held_until_the_next_line) {
  std::string text = kRobotWithoutTicks;
  const auto counted = drive();
  for (std::size_t i = 0; i + 1 < counted.size(); ++i) {
    const double held = counted[i + 1].t - counted[i].t;
    text += line("wheel_speeds", counted[i].t, angle(counted[i + 1].left - counted[i].left) / held,
                 angle(counted[i + 1].right - counted[i].right) / held);
  }
  text += line("wheel_speeds", counted.back().t, 0.0, 0.0);
  const auto result = value_of(read_text(text));
  EXPECT_EQ(result.motion, MotionSource::wheel_speeds);
  expect_same_motion(result, counted, 6e-6);
}

/// Odometry as robots compute it: x and y along the heading in the middle of the step, or along the exact
/// arc.
std::string odometry_of(const std::vector<TickSample>& ticks, bool exact) {
  std::string text;
  double x = 0.0, y = 0.0, yaw = 0.0;
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    if (i > 0) {
      const double left = 0.075 * angle(ticks[i].left - ticks[i - 1].left);
      const double right = 0.075 * angle(ticks[i].right - ticks[i - 1].right);
      const double turn = (right - left) / 0.4, way = 0.5 * (left + right);
      const double chord = exact && turn != 0.0 ? way * std::sin(0.5 * turn) / (0.5 * turn) : way;
      x += chord * std::cos(yaw + 0.5 * turn);
      y += chord * std::sin(yaw + 0.5 * turn);
      yaw += turn;
    }
    text += odometry_line(ticks[i].t, x, y, std::remainder(yaw, kTurn));
  }
  return text;
}

TEST(WheelMotion, odometry_is_turned_back_with_the_nominal_values) {
  for (const bool exact : {true, false}) {
    const auto result = value_of(read_text(kRobotWithoutTicks + odometry_of(drive(), exact)));
    EXPECT_EQ(result.motion, MotionSource::odometry);
    expect_same_motion(result, drive(), exact ? 6e-6 : 2e-3);
  }
}

TEST(WheelMotion, odometry_that_starts_again_at_the_origin_begins_a_segment) {
  std::string text = kRobotWithoutTicks;
  for (int k = 0; k < 100; ++k) text += odometry_line(0.02 * k, 1.0 + 0.004 * k, 0.5, 0.3);
  for (int k = 0; k < 100; ++k) text += odometry_line(2.0 + 0.02 * k, 0.004 * k, 0.0, 0.0);
  const auto result = value_of(read_text(text));
  const auto& ticks = result.ticks;
  ASSERT_EQ(ticks.size(), 200U);
  EXPECT_EQ(ticks[99].segment, 0);
  EXPECT_EQ(ticks[100].segment, 1);
  EXPECT_EQ(ticks[199].segment, 1);
}

TEST(WheelMotion, the_finest_decides_and_the_others_are_counted) {
  const std::string ticks = R"({"type":"ticks","t":0,"left":0,"right":0}
{"type":"ticks","t":1,"left":9,"right":9}
)";
  const std::string wheels = line("wheels", 0, 0, 0) + line("wheels", 1, 0.5, 0.5);
  const std::string speeds = line("wheel_speeds", 0, 1, 1) + line("wheel_speeds", 1, 1, 1);
  const std::string odometry = odometry_line(0, 0, 0, 0) + odometry_line(1, 0.1, 0, 0);
  const auto read = [&](const std::string& lines) {
    auto result = read_text(kRobotWithTicks + lines);
    EXPECT_TRUE(result.ok());
    return result.ok() ? std::move(result).value() : Recording{};
  };
  Recording r = read(odometry + speeds + wheels + ticks);
  EXPECT_EQ(r.motion, MotionSource::ticks);
  EXPECT_EQ(discarded(r, "wheels", "ticks are finer and decide"), 2U);
  EXPECT_EQ(discarded(r, "wheel_speeds", "ticks are finer and decide"), 2U);
  EXPECT_EQ(discarded(r, "odometry", "ticks are finer and decide"), 2U);
  EXPECT_TRUE(r.choices.empty()) << "ticks are what a recording is expected to hold";
  r = read(odometry + speeds + wheels);
  EXPECT_EQ(r.motion, MotionSource::wheels);
  EXPECT_EQ(discarded(r, "wheel_speeds", "wheels are finer and decide"), 2U);
  r = read(odometry + speeds);
  EXPECT_EQ(r.motion, MotionSource::wheel_speeds);
  r = read(odometry);
  EXPECT_EQ(r.motion, MotionSource::odometry);
}

TEST(WheelMotion, needs_no_counts_a_turn_but_the_dimensions) {
  EXPECT_TRUE(read_text(kRobotWithoutTicks + odometry_of(drive(), true)).ok());
  const auto result = read_text(R"({"type":"robot","wheel_diameter":0.15})"
                                "\n" +
                                odometry_of(drive(), true));
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::missing_units);
  EXPECT_NE(result.error().what.find("track_width"), std::string::npos) << result.error().text();
}

TEST(WheelMotion, values_that_are_none_are_left_out_by_name) {
  const auto result = value_of(read_text(std::string(kRobotWithTicks) + line("wheels", 0, 0, 0) +
                                         line("wheels", 1, 0.5, 0.5) +
                                         R"({"type":"wheels","t":2,"left":1e12,"right":0}
{"type":"wheels","t":2,"left":null,"right":0}
{"type":"wheel_speeds","t":0,"left":1e6,"right":0}
{"type":"odometry","t":0,"x":NaN,"y":0,"yaw":0}
{"type":"odometry","t":0,"x":1e12,"y":0,"yaw":0}
)"));
  EXPECT_EQ(discarded(result, "wheels", "left or right missing or not an angle"), 2U);
  EXPECT_EQ(discarded(result, "wheel_speeds", "left or right missing or not the speed of a wheel"), 1U);
  EXPECT_EQ(discarded(result, "odometry", "x, y or yaw missing or impossible"), 2U);
}

TEST(WheelMotion, survives_writing_as_it_was_recorded) {
  std::string wheels, speeds;
  for (const TickSample& s : drive()) {
    wheels += line("wheels", s.t, angle(s.left) + 0.01 * std::sin(s.t), angle(s.right));
    speeds += line("wheel_speeds", s.t, std::sin(s.t), std::cos(s.t));
  }
  for (const std::string& lines : {wheels, speeds, odometry_of(drive(), true)}) {
    const auto first = value_of(read_text(kRobotWithoutTicks + lines));
    const auto path = test::write_file("wheel_motion.jsonl.gz", "");
    ASSERT_TRUE(write_recording_jsonl(first, path).ok());
    const auto second = read_recording(path);
    std::filesystem::remove(path);
    ASSERT_TRUE(second.ok()) << second.error().text();
    EXPECT_EQ(second.value().motion, first.motion);
    EXPECT_EQ(second.value().robot.ticks_per_rev, first.robot.ticks_per_rev);
    ASSERT_EQ(second.value().ticks.size(), first.ticks.size());
    for (std::size_t i = 0; i < first.ticks.size(); ++i) {
      EXPECT_EQ(second.value().ticks[i].left, first.ticks[i].left);
      EXPECT_EQ(second.value().ticks[i].right, first.ticks[i].right);
    }
  }
}

}  // namespace
}  // namespace odomcalib::wheel_motion_test
