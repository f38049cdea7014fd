#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>

#include "daemon/routines/manoeuvres.hpp"
#include "daemon/routines/plans.hpp"
#include "daemon/routines/runner.hpp"

namespace odomcalib::routines::routines_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDt = 0.02;

// First-order lag of the drives: the command is followed with a time constant, as real motors do.
struct Model {
  Pose pose;
  Twist actual;
  double lag = 0.05;

  void step(const Twist& command) {
    const double share = lag > 0.0 ? std::min(1.0, kDt / lag) : 1.0;
    actual.v += share * (command.v - actual.v);
    actual.w += share * (command.w - actual.w);
    pose.x += actual.v * kDt * std::cos(pose.yaw);
    pose.y += actual.v * kDt * std::sin(pose.yaw);
    pose.yaw = wrapped(pose.yaw + actual.w * kDt);
  }
};

struct Trace {
  double duration = 0.0, reach = 0.0, forward = 0.0, turned = 0.0;
  double fastest = 0.0, fastest_turn = 0.0, hardest = 0.0, hardest_turn = 0.0;
  int starts = 0;
  Pose end;
  std::vector<Twist> commands;
  bool finished = false;
};

Trace drive(const Plan& plan, double lag = 0.05) {
  Model model{.pose = {}, .actual = {}, .lag = lag};
  Runner runner(plan);
  Trace trace;
  Twist before;
  while (!runner.done() && trace.duration < 1000.0) {
    const Twist command = runner.step(trace.duration, model.pose);
    trace.hardest = std::max(trace.hardest, (std::abs(command.v) - std::abs(before.v)) / kDt);
    trace.hardest_turn = std::max(trace.hardest_turn, (std::abs(command.w) - std::abs(before.w)) / kDt);
    const bool moving = command.v != 0.0 || command.w != 0.0;
    if (moving && before.v == 0.0 && before.w == 0.0) ++trace.starts;
    before = command;
    const double yaw = model.pose.yaw;
    model.step(command);
    trace.turned += wrapped(model.pose.yaw - yaw);
    trace.forward = std::max(trace.forward, model.pose.x);
    trace.reach = std::max({trace.reach, std::abs(model.pose.x), std::abs(model.pose.y)});
    trace.fastest = std::max(trace.fastest, std::abs(command.v));
    trace.fastest_turn = std::max(trace.fastest_turn, std::abs(command.w));
    trace.duration += kDt;
    trace.commands.push_back(command);
  }
  trace.end = model.pose;
  trace.finished = runner.done();
  return trace;
}

TEST(Straight, goes_out_by_the_distance_and_comes_back) {
  const Trace trace = drive(straight_plan({.distance = 1.0, .speed = 0.2, .repeat = 1, .limits = {}}));
  EXPECT_TRUE(trace.finished);
  EXPECT_NEAR(trace.forward, 1.0, 0.01);
  EXPECT_NEAR(trace.end.x, 0.0, 0.02);
  EXPECT_EQ(trace.starts, 2);
}

TEST(Straight, backwards_first_when_the_distance_is_negative) {
  const Trace trace = drive(straight_plan({.distance = -0.5, .speed = 0.2, .repeat = 1, .limits = {}}));
  EXPECT_LT(trace.forward, 0.01);
  EXPECT_NEAR(trace.reach, 0.5, 0.01);
}

TEST(Spin, SD_18_counts_full_turns_through_the_jump_of_the_angle) {
  SpinOptions options;
  options.turns = 2.0;
  options.right = false;
  const Trace trace = drive(spin_plan(options));
  EXPECT_TRUE(trace.finished);
  EXPECT_NEAR(trace.turned, 4.0 * kPi, 0.03);
}

TEST(Spin, left_and_right_cancel) {
  const Trace trace = drive(spin_plan({}));
  EXPECT_NEAR(trace.turned, 0.0, 0.04);
  EXPECT_EQ(trace.starts, 2);
}

TEST(Limits, in_force_are_named_once_for_each_move) {
  StraightOptions options;
  options.speed = 0.5;
  options.repeat = 3;
  EXPECT_EQ(limited(straight_plan(options)),
            (std::vector<std::string>{"straight forward: 0.30 m/s instead of 0.50, the limit",
                                      "straight backward: 0.30 m/s instead of 0.50, the limit"}));
  options.speed = 0.15;
  EXPECT_TRUE(limited(straight_plan(options)).empty());
  options.limits.speed = 0.1;
  EXPECT_EQ(limited(straight_plan(options)).size(), 2U);
  SpinOptions spin;
  spin.rate = 0.7;
  spin.right = false;
  EXPECT_EQ(limited(spin_plan(spin)),
            (std::vector<std::string>{"spin left: 0.60 rad/s instead of 0.70, the limit"}));
}

TEST(Limits, cannot_be_raised_by_configuration) {
  const Limits wanted{2.0, 5.0, 9.0, 9.0};
  EXPECT_EQ(capped(wanted).speed, kCaps.speed);
  EXPECT_EQ(capped(wanted).turn_rate, kCaps.turn_rate);
  EXPECT_EQ(capped({0.1, 0.2, 0.3, 0.4}).speed, 0.1);
  EXPECT_EQ(capped({std::nan(""), -1.0, 0.0, std::numeric_limits<double>::infinity()}).speed, kCaps.speed);
  EXPECT_EQ(capped({0.1, -1.0, 0.3, 0.4}).turn_rate, kCaps.turn_rate);
}

TEST(Limits, hold_for_every_command_whatever_speed_is_asked_for) {
  Plan plan = straight_plan({.distance = 1.0, .speed = 9.0, .repeat = 1, .limits = {9.0, 9.0, 9.0, 9.0}});
  plan.moves.push_back(spin(kPi, 9.0));
  plan.moves.push_back(arc(0.5, kPi, 9.0, true));
  const Trace trace = drive(plan);
  EXPECT_TRUE(trace.finished);
  EXPECT_NEAR(trace.fastest, kCaps.speed, 1e-9);
  EXPECT_NEAR(trace.fastest_turn, kCaps.turn_rate, 1e-9);
  EXPECT_LE(trace.hardest, kCaps.acceleration + 1e-9);
  EXPECT_LE(trace.hardest_turn, kCaps.turn_acceleration + 1e-9);
}

TEST(Runner, commands_zero_for_a_pose_that_is_not_finite) {
  Runner runner(straight_plan({}));
  for (int i = 0; i < 50; ++i) runner.step(kDt * i, {});
  const Twist twist = runner.step(1.02, {std::nan(""), 0.0, 0.0});
  EXPECT_EQ(twist.v, 0.0);
  EXPECT_EQ(twist.w, 0.0);
}

TEST(Runner, is_a_function_of_its_arguments) {
  const Plan plan = straight_plan({});
  const Step first = next_step(plan, {}, {}, 0.0);
  const Step again = next_step(plan, first.state, {0.01, 0.0, 0.0}, 0.02);
  const Step repeated = next_step(plan, first.state, {0.01, 0.0, 0.0}, 0.02);
  EXPECT_EQ(again.twist.v, repeated.twist.v);
  EXPECT_EQ(again.state.pace, repeated.state.pace);
}

TEST(Runner, an_empty_plan_is_done_at_once) {
  Runner runner({});
  EXPECT_TRUE(runner.done());
  EXPECT_EQ(runner.step(0.0, {}).v, 0.0);
}

TEST(ToWheels, a_straight_metre_per_second_turns_each_wheel_by_its_own_diameter) {
  const WheelRates rates = to_wheels({1.0, 0.0}, {0.2, 0.1, 0.4});
  EXPECT_DOUBLE_EQ(rates.left, 10.0);
  EXPECT_DOUBLE_EQ(rates.right, 20.0);
}

TEST(ToWheels, a_turn_to_the_left_drives_the_right_wheel_forward) {
  const WheelRates rates = to_wheels({0.0, 1.0}, {0.2, 0.2, 0.4});
  EXPECT_DOUBLE_EQ(rates.left, -2.0);
  EXPECT_DOUBLE_EQ(rates.right, 2.0);
}

TEST(ToWheels, nothing_moves_without_lengths_or_with_a_command_that_is_not_finite) {
  EXPECT_EQ(to_wheels({1.0, 1.0}, {}).left, 0.0);
  EXPECT_EQ(to_wheels({std::nan(""), 0.0}, {0.2, 0.2, 0.4}).right, 0.0);
}

class PatternInArea : public testing::TestWithParam<std::tuple<double, double, bool>> {};

TEST_P(PatternInArea, stays_inside_and_ends_where_it_began) {
  const auto [length, width, quick] = GetParam();
  PatternOptions options;
  options.area_length = length;
  options.area_width = width;
  options.quick = quick;
  const Trace trace = drive(pattern_plan(options));
  EXPECT_TRUE(trace.finished);
  EXPECT_LE(trace.reach, 0.5 * std::min(length, width) + 0.03);
  EXPECT_NEAR(trace.end.x, 0.0, 0.06);
  EXPECT_NEAR(trace.end.y, 0.0, 0.06);
  EXPECT_LE(trace.fastest, kCaps.speed + 1e-9);
  EXPECT_LE(trace.fastest_turn, kCaps.turn_rate + 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Areas, PatternInArea,
                         testing::Combine(testing::Values(1.2, 2.0, 4.0), testing::Values(1.2, 2.0),
                                          testing::Bool()));

class Manoeuvre : public testing::TestWithParam<const char*> {};

TEST_P(Manoeuvre, stays_in_the_area_comes_back_and_takes_no_longer_than_a_pattern) {
  for (const double side : {1.2, 2.0}) {
    PatternOptions options;
    options.area_length = options.area_width = side;
    const auto plan = manoeuvre_plan(GetParam(), options);
    ASSERT_TRUE(plan.has_value());
    const Trace trace = drive(*plan);
    EXPECT_TRUE(trace.finished);
    EXPECT_LE(trace.reach, 0.5 * side + 0.03);
    EXPECT_NEAR(trace.end.x, 0.0, 0.06);
    EXPECT_NEAR(trace.end.y, 0.0, 0.06);
    EXPECT_LE(trace.fastest, kCaps.speed + 1e-9);
    EXPECT_LE(trace.fastest_turn, kCaps.turn_rate + 1e-9);
    EXPECT_LT(preview(*plan).duration, 200.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Names, Manoeuvre,
                         testing::Values("straights", "slow_straights", "turns", "arcs", "accelerations",
                                         "reversals", "headings"),
                         [](const auto& name) { return std::string(name.param); });

TEST(Accelerations, rest_for_many_different_times) {
  std::set<double> rests;
  const auto plan = manoeuvre_plan("accelerations", {});
  ASSERT_TRUE(plan.has_value());
  for (const Move& move : plan->moves) rests.insert(move.settle);
  EXPECT_GE(rests.size(), 6U);
  EXPECT_LT(*rests.begin(), 0.2);
  EXPECT_GT(*rests.rbegin(), 0.5);
}

TEST(Accelerations, push_at_many_different_strengths) {
  std::set<double> hardest;
  const auto plan = manoeuvre_plan("accelerations", {});
  ASSERT_TRUE(plan.has_value());
  for (const Move& move : plan->moves)
    if (move.direction.w == 0.0) hardest.insert(profile_of(move, plan->limits).acceleration);
  EXPECT_GE(hardest.size(), 5U);
  EXPECT_LT(*hardest.begin(), 0.15);
  EXPECT_LE(*hardest.rbegin(), kCaps.acceleration);
}

TEST(Move, no_haste_goes_beyond_the_limits_or_comes_to_nothing) {
  Move move = straight(1.0, 0.3);
  for (const auto& [haste, share] : {std::pair{7.0, 1.0}, std::pair{0.5, 0.5}, std::pair{-1.0, 0.1}}) {
    move.haste = haste;
    EXPECT_DOUBLE_EQ(profile_of(move, {}).acceleration, share * kCaps.acceleration) << haste;
  }
}

TEST(ManoeuvreNames, others_are_refused) { EXPECT_FALSE(manoeuvre_plan("pirouette", {}).has_value()); }

TEST(Pattern, takes_less_than_six_minutes_and_the_quick_one_less_than_half) {
  const double full = preview(pattern_plan({})).duration;
  PatternOptions options;
  options.quick = true;
  const double quick = preview(pattern_plan(options)).duration;
  EXPECT_GT(full, 200.0);
  EXPECT_LT(full, 360.0);
  EXPECT_LT(quick, 0.5 * full);
}

TEST(Pattern, contains_what_keeps_the_effects_apart) {
  const Plan plan = pattern_plan({});
  std::set<std::pair<int, int>> signs;
  std::set<int> forward_speeds, spin_rates;
  int single_wheel = 0;
  for (const Move& move : plan.moves) {
    const auto sign = [](double value) { return value > 0.0 ? 1 : value < 0.0 ? -1 : 0; };
    signs.insert({sign(move.direction.v), sign(move.direction.w)});
    if (move.direction.w == 0.0) forward_speeds.insert(static_cast<int>(std::lround(1000.0 * move.pace)));
    if (move.direction.v == 0.0) spin_rates.insert(static_cast<int>(std::lround(1000.0 * move.pace)));
    if (std::abs(std::abs(move.direction.v) - 0.2) < 1e-9) ++single_wheel;
  }
  for (const int v : {-1, 1})
    for (const int w : {-1, 0, 1}) EXPECT_TRUE(signs.contains({v, w})) << v << " " << w;
  EXPECT_TRUE(signs.contains({0, 1}) && signs.contains({0, -1}));
  EXPECT_GE(forward_speeds.size(), 7U) << "between speeds a law is guessed";
  EXPECT_GE(spin_rates.size(), 3U);
  EXPECT_GE(single_wheel, 4);
  EXPECT_GE(drive(plan).starts, 20);
  EXPECT_EQ(plan.moves.front().amount, plan.moves[plan.moves.size() - 2].amount);
}

TEST(Pattern, passes_every_speed_slowly) {
  std::set<int> cm_per_s, cg_per_s;  // hundredths, of m/s and rad/s, either way
  Twist before;
  for (const Twist& now : drive(pattern_plan({})).commands) {
    const auto hundredths = [](double value) { return static_cast<int>(std::lround(100.0 * value)); };
    const bool slow_change =
        std::abs(now.v - before.v) < 0.12 * kDt && std::abs(now.w - before.w) < 0.12 * kDt;
    if (slow_change && now.w == 0.0) cm_per_s.insert(hundredths(now.v));
    if (slow_change && now.v == 0.0) cg_per_s.insert(hundredths(now.w));
    before = now;
  }
  for (int speed = 2; speed <= 30; ++speed)
    EXPECT_TRUE(cm_per_s.contains(speed) && cm_per_s.contains(-speed)) << speed << " cm/s";
  for (int rate = 4; rate <= 60; rate += 2)
    EXPECT_TRUE(cg_per_s.contains(rate) && cg_per_s.contains(-rate)) << 0.01 * rate << " rad/s";
}

TEST(Pattern, rests_and_pushes_of_many_kinds) {
  std::set<double> rests, hastes;
  for (const Move& move : pattern_plan({}).moves) {
    rests.insert(move.settle);
    hastes.insert(move.haste);
  }
  EXPECT_GE(rests.size(), 6U);
  EXPECT_GE(hastes.size(), 5U);
}

TEST(Pattern, a_thousand_runs_take_seconds) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> lag(0.0, 0.15);
  const Plan plan = straight_plan({});
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 1000; ++i) {
    const Trace trace = drive(plan, lag(random));
    ASSERT_TRUE(trace.finished);
    ASSERT_NEAR(trace.forward, 1.0, 0.04);
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
}

}  // namespace
}  // namespace odomcalib::routines::routines_test
