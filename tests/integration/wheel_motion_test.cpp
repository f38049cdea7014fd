// The same simulated drive, its counts told as wheel angles, wheel speeds and odometry: the same calibration.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "calib/odometry/predict.hpp"
#include "calib/solve.hpp"
#include "proto/recording/recording.hpp"
#include "tests/sim/world/rooms.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib {
namespace {

// Of the standard deviations: what the way of telling may move a value by. Angles are the same numbers;
// speeds and odometry round to other counts than the encoder, by less than a tenth of one.
constexpr double kSameAngles = 1e-6, kSameWithin = 0.5;

struct Told {
  MotionSource as;
  double sigmas;
};

class WheelMotionSolve : public ::testing::TestWithParam<Told> {};

Recording drive() {
  sim::SimulationConfig config = sim::standard_config(5);
  const sim::Drive drive = sim::follow(config.nominal, sim::guided_pattern());
  return sim::simulate_recording(config, drive).recording;
}

std::string number(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.17g", value);
  return text.data();
}

/// The drive as JSON Lines without its counts, and without counts a turn where they would not be known.
std::string told_as(const Recording& recording, MotionSource as) {
  const RobotDescription& robot = recording.robot;
  std::string text = R"({"type":"robot","wheel_diameter":)" + number(robot.left_wheel_diameter) +
                     R"(,"track_width":)" + number(robot.track_width);
  if (as == MotionSource::wheels) text += R"(,"ticks_per_rev":)" + number(robot.ticks_per_rev);
  if (robot.lidar_pose)
    text += R"(,"lidar_pose":[)" + number((*robot.lidar_pose)[0]) + "," + number((*robot.lidar_pose)[1]) +
            "," + number((*robot.lidar_pose)[2]) + "]";
  text += "}\n";
  const double rad = 2.0 * std::numbers::pi / robot.ticks_per_rev;
  double x = 0.0, y = 0.0, yaw = 0.0;
  for (std::size_t i = 0; i < recording.ticks.size(); ++i) {
    const TickSample& now = recording.ticks[i];
    const TickSample& next = recording.ticks[std::min(i + 1, recording.ticks.size() - 1)];
    const double left = rad * static_cast<double>(next.left - now.left);
    const double right = rad * static_cast<double>(next.right - now.right);
    text += R"({"type":")" + std::string(name_of(as)) + R"(","t":)" + number(now.t);
    if (as == MotionSource::odometry) {
      text += R"(,"x":)" + number(x) + R"(,"y":)" + number(y) + R"(,"yaw":)" + number(yaw) + "}\n";
      const double turn =
          (right * robot.right_wheel_diameter - left * robot.left_wheel_diameter) / 2.0 / robot.track_width;
      const double way = (right * robot.right_wheel_diameter + left * robot.left_wheel_diameter) / 4.0;
      x += way * std::cos(yaw + 0.5 * turn);
      y += way * std::sin(yaw + 0.5 * turn);
      yaw += turn;
      continue;
    }
    const double held = std::max(next.t - now.t, 1e-9);
    const bool angles = as == MotionSource::wheels;
    text += R"(,"left":)" + number(angles ? rad * static_cast<double>(now.left) : left / held) +
            R"(,"right":)" + number(angles ? rad * static_cast<double>(now.right) : right / held) + "}\n";
  }
  return text;
}

Recording retold(const Recording& counted, MotionSource as) {
  auto result = read_recording_bytes(told_as(counted, as), "retold.jsonl");
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().text());
  Recording out = result.ok() ? std::move(result).value() : Recording{};
  out.scans = counted.scans;
  return out;
}

TEST_P(WheelMotionSolve, gives_the_same_calibration_and_the_same_odometry) {
  const Recording counted = drive();
  const Recording told = retold(counted, GetParam().as);
  ASSERT_EQ(told.motion, GetParam().as);
  ASSERT_EQ(told.ticks.size(), counted.ticks.size());
  const Calibration expected = calib::solve({&counted, 1}, {.effects = {"none"}});
  const Calibration found = calib::solve({&told, 1}, {.effects = {"none"}});
  ASSERT_NE(expected.verdict, Verdict::refused) << expected.reasons.front();
  ASSERT_EQ(found.verdict, expected.verdict) << found.reasons.front();
  ASSERT_EQ(found.parameters.size(), 6U);
  for (std::size_t k = 0; k < found.parameters.size(); ++k) {
    const auto& [name, quantity] = found.parameters[k];
    const Quantity& reference = expected.parameters[k].second;
    const double sigmas = std::abs(quantity.value - reference.value) / reference.std;
    std::printf("%s %s: %.6f and %.6f, %.3g sigma\n", name_of(GetParam().as), name.c_str(), quantity.value,
                reference.value, sigmas);
    EXPECT_LT(sigmas, GetParam().sigmas) << name;
    EXPECT_NEAR(quantity.std, reference.std, 0.1 * reference.std) << name;
  }
  const PoseSample end = calib::predict(told, expected).back(),
                   same = calib::predict(counted, expected).back();
  EXPECT_NEAR(end.x, same.x, 1e-3);
  EXPECT_NEAR(end.y, same.y, 1e-3);
  EXPECT_NEAR(end.yaw, same.yaw, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Forms, WheelMotionSolve,
                         ::testing::Values(Told{MotionSource::wheels, kSameAngles},
                                           Told{MotionSource::wheel_speeds, kSameWithin},
                                           Told{MotionSource::odometry, kSameWithin}),
                         [](const auto& info) { return std::string(name_of(info.param.as)); });

}  // namespace
}  // namespace odomcalib
