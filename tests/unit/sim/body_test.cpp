// The simulated mechanics against closed-form physics.
#include "tests/sim/world/body.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace odomcalib::sim::body_test {
namespace {

constexpr double kPi = std::numbers::pi;

Geometry unequal_robot() {
  Geometry robot;
  robot.left_diameter = 0.151;
  robot.right_diameter = 0.148;
  robot.track_width = 0.410;
  robot.ticks_per_rev = 1000.0;
  return robot;
}

void run(Body& body, double seconds) {
  const auto steps = std::llround(seconds / body.step_length());
  for (long step = 0; step < steps; ++step) body.advance();
}

TEST(Body, reaches_the_commanded_wheel_speed_no_faster_than_the_ramp) {
  BodyOptions options;
  options.motor.acceleration = 8.0;
  Body body(unequal_robot(), options, 1);
  body.command(4.0, -2.0);
  double before = 0.0;
  for (int step = 0; step < 1500; ++step) {
    body.advance();
    EXPECT_LE(std::abs(body.rate()[kLeft] - before) / options.step, 8.0 + 1e-9);
    before = body.rate()[kLeft];
  }
  EXPECT_NEAR(body.rate()[kLeft], 4.0, 1e-6);
  EXPECT_NEAR(body.rate()[kRight], -2.0, 1e-6);
}

TEST(Body, S3_01_drives_a_circle_whose_radius_follows_from_the_wheel_speeds) {
  const Geometry robot = unequal_robot();
  Body body(robot, {}, 1);
  body.command(3.0, 5.0);
  run(body, 2.0);  // steady state
  const double left = 3.0 * robot.left_diameter / 2.0, right = 5.0 * robot.right_diameter / 2.0;
  const double radius = robot.track_width / 2.0 * (right + left) / (right - left);
  const Pose entry = body.pose();
  const Vec2 centre{entry.x - radius * std::sin(entry.yaw), entry.y + radius * std::cos(entry.yaw)};
  const double turn_time = 2.0 * kPi * robot.track_width / (right - left);
  for (int piece = 0; piece < 10; ++piece) {
    run(body, turn_time / 10.0);
    const double distance = std::hypot(body.pose().x - centre.x, body.pose().y - centre.y);
    EXPECT_NEAR(distance, radius, 1e-5);
  }
  EXPECT_NEAR(body.pose().yaw - entry.yaw, 2.0 * kPi, 0.002);  // ten times the step is rounded to 1 ms
}

TEST(Body, turns_by_the_rim_difference_over_the_track_whatever_the_speeds) {
  const Geometry robot = unequal_robot();
  Body body(robot, {}, 1);
  for (const auto& [left, right] : {std::pair{2.0, -3.0}, {5.0, 1.0}, {-4.0, -4.0}, {0.0, 0.0}}) {
    body.command(left, right);
    run(body, 1.0);
  }
  const double rim =
      (body.angle()[kRight] * robot.right_diameter - body.angle()[kLeft] * robot.left_diameter) / 2.0;
  EXPECT_NEAR(body.pose().yaw, rim / robot.track_width, 1e-10);
}

TEST(Body, counts_one_turn_of_the_wheel_within_one_count) {
  Body body(unequal_robot(), {}, 7);
  body.command(2.0 * kPi, -2.0 * kPi);
  while (body.angle()[kLeft] < 2.0 * kPi) body.advance();
  EXPECT_NEAR(static_cast<double>(body.counts()[kLeft]), 1000.0, 1.0 + 1000.0 * 0.001);
  EXPECT_NEAR(static_cast<double>(body.counts()[kRight]), -1000.0, 1.0 + 1000.0 * 0.001);
  EXPECT_NEAR(static_cast<double>(body.counts()[kLeft]), body.angle()[kLeft] / (2.0 * kPi) * 1000.0, 1.0);
}

TEST(Body, starts_at_count_zero_with_a_phase_that_depends_on_the_seed) {
  EXPECT_EQ(Body(unequal_robot(), {}, 3).counts(), (std::array<std::int64_t, 2>{0, 0}));
  const auto first_count_after = [](std::uint64_t seed) {
    Body body(unequal_robot(), {}, seed);
    body.command(0.05, 0.05);
    int steps = 0;
    for (; body.counts()[kLeft] == 0; ++steps) body.advance();
    return steps;
  };
  EXPECT_NE(first_count_after(3), first_count_after(4));
  EXPECT_EQ(first_count_after(3), first_count_after(3));
}

TEST(Body, coasts_to_rest_without_torque_and_does_not_roll_back) {
  Body body(unequal_robot(), {}, 1);
  body.command(5.0, 5.0);
  run(body, 1.0);
  const double angle = body.angle()[kLeft];
  body.release();
  run(body, 2.0);
  EXPECT_EQ(body.rate()[kLeft], 0.0);
  EXPECT_NEAR(body.angle()[kLeft] - angle, 5.0 * 5.0 / (2.0 * MotorOptions{}.coasting), 0.02);
}

TEST(Body, slip_noise_spreads_with_the_square_root_of_the_distance) {
  BodyOptions options;
  options.slip_noise = 0.002;
  double sum2 = 0.0;
  constexpr int kRuns = 60;
  for (int i = 0; i < kRuns; ++i) {
    Body body(unequal_robot(), options, 100 + static_cast<std::uint64_t>(i));
    body.command(5.0, 5.0);
    run(body, 2.0);
    const Geometry robot = unequal_robot();
    const double ideal =
        (body.angle()[kRight] * robot.right_diameter - body.angle()[kLeft] * robot.left_diameter) / 2.0 /
        robot.track_width;
    const double error = body.pose().yaw - ideal;
    sum2 += error * error;
  }
  const double distance = 0.075 * 5.0 * (2.0 - 0.25 / 2.0 - 0.03);
  const double expected = options.slip_noise * std::sqrt(2.0 * distance) / unequal_robot().track_width;
  EXPECT_NEAR(std::sqrt(sum2 / kRuns) / expected, 1.0, 0.3);  // 60 draws: standard error 9 %
}

class Shove : public Disturbance {
 public:
  [[nodiscard]] std::string name() const override { return "shove"; }
  void on_step(const StepView& view, StepMotion& motion) override {
    motion.side = 0.1 * view.dt;
    motion.travel[kLeft] += 0.2 * view.dt;
    motion.travel[kRight] += 0.2 * view.dt;
  }
  void on_encoder(const StepView&, PerSide& angle) override { angle[kRight] = 2.0 * kPi * 5.5; }
};

TEST(Body, effects_move_the_base_and_the_encoder_independently) {
  Body body(unequal_robot(), {}, 1, {std::make_shared<Shove>()});
  run(body, 2.0);
  EXPECT_NEAR(body.pose().x, 0.4, 1e-9);
  EXPECT_NEAR(body.pose().y, 0.2, 1e-9);
  EXPECT_EQ(body.counts()[kLeft], 0);
  EXPECT_EQ(body.counts()[kRight], 5500);
}

}  // namespace
}  // namespace odomcalib::sim::body_test
