// A simulated drive whose counts are told as wheel angles, wheel speeds and odometry: the same calibration,
// as near to the truth as is stated.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "calib/odometry/predict.hpp"
#include "calib/solve.hpp"
#include "proto/recording/recording.hpp"
#include "tests/integration/accuracy_runs.hpp"
#include "tests/sim/world/rooms.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib::wheel_motion_test {
namespace {

// Largest change of a value by the form of the wheel motion, in standard deviations. Angles on the encoder's
// grid give the same counts. Speeds and odometry are counted on a finer grid, where other roundings end the
// iterations elsewhere: twice the largest that was seen, 0.10 over four seeds.
constexpr double kSameCounts = 1e-6, kSameWithin = 0.2;
// Stated standard deviations; the largest of 27 lengths was 2.35.
constexpr double kHonest = 3.5;

struct Told {
  MotionSource as;
  double sigmas;
};

class WheelMotionSolve : public ::testing::TestWithParam<Told> {};

sim::SimulatedRun drive(std::uint64_t seed) {
  const sim::SimulationConfig config = sim::standard_config(seed);
  return sim::simulate_recording(config, sim::follow(config.nominal, sim::guided_pattern()));
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

std::string reasons(const Calibration& result) {
  std::string text;
  for (const std::string& reason : result.reasons) text += reason + "\n";
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
  const Recording counted = drive(5).recording;
  const Recording told = retold(counted, GetParam().as);
  ASSERT_EQ(told.motion, GetParam().as);
  ASSERT_EQ(told.ticks.size(), counted.ticks.size());
  const Calibration expected = calib::solve({&counted, 1}, {.effects = {"none"}});
  const Calibration found = calib::solve({&told, 1}, {.effects = {"none"}});
  ASSERT_NE(expected.verdict, Verdict::refused) << reasons(expected);
  ASSERT_EQ(found.verdict, expected.verdict) << reasons(found);
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
  const PoseSample end = calib::odometry::predict(told, expected).back(),
                   same = calib::odometry::predict(counted, expected).back();
  EXPECT_NEAR(end.x, same.x, 1e-3);
  EXPECT_NEAR(end.y, same.y, 1e-3);
  EXPECT_NEAR(end.yaw, same.yaw, 1e-3);
}

TEST_P(WheelMotionSolve, lengths_are_off_by_no_more_than_is_stated) {
  for (std::uint64_t seed = 11; seed < 14; ++seed) {
    const sim::SimulatedRun run = drive(seed);
    const Recording told = retold(run.recording, GetParam().as);
    const Calibration result = calib::solve({&told, 1}, {.effects = {"none"}});
    ASSERT_NE(result.verdict, Verdict::refused) << "seed " << seed << ": " << reasons(result);
    for (const double sigma : test_support::length_errors_in_sigmas(result, run.truth)) {
      std::printf("%s, seed %d: %.2f sigma\n", name_of(GetParam().as), static_cast<int>(seed), sigma);
      EXPECT_LT(std::abs(sigma), kHonest) << "seed " << seed;
    }
  }
}

/// Drivers publish the mean speed since their last message: held until the next one it comes an interval
/// late.
TEST(WheelSpeedSolve, speeds_of_the_interval_before_are_a_delay_that_is_found) {
  const sim::SimulatedRun run = drive(5);
  Recording late = retold(run.recording, MotionSource::wheel_speeds);
  const double interval = late.ticks[1].t - late.ticks[0].t;
  for (TickSample& sample : late.ticks) sample.t += interval;
  const Calibration result = calib::solve({&late, 1}, {});
  ASSERT_EQ(result.verdict, Verdict::accepted) << reasons(result);
  ASSERT_EQ(result.effects.size(), 1U);
  EXPECT_EQ(result.effects.front().name, "time_offset");
  EXPECT_NEAR(result.effects.front().parameters.front().second.value, -interval, 0.05 * interval);
  for (const double sigma : test_support::length_errors_in_sigmas(result, run.truth))
    EXPECT_LT(std::abs(sigma), kHonest);
}

INSTANTIATE_TEST_SUITE_P(Forms, WheelMotionSolve,
                         ::testing::Values(Told{MotionSource::wheels, kSameCounts},
                                           Told{MotionSource::wheel_speeds, kSameWithin},
                                           Told{MotionSource::odometry, kSameWithin}),
                         [](const auto& test) { return std::string(name_of(test.param.as)); });

}  // namespace
}  // namespace odomcalib::wheel_motion_test
