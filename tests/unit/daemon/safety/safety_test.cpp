#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "daemon/routines/plans.hpp"
#include "daemon/safety/braking.hpp"
#include "daemon/safety/clear_space.hpp"
#include "daemon/safety/cover.hpp"
#include "daemon/safety/envelope.hpp"
#include "daemon/safety/freshness.hpp"
#include "daemon/safety/lease.hpp"
#include "daemon/safety/obstacle.hpp"
#include "daemon/safety/speed_watch.hpp"
#include "daemon/safety/stop_guard.hpp"
#include "tests/value_of.hpp"

namespace odomcalib::safety::safety_test {
namespace {

Scan scan_with(float range) {
  Scan scan;
  scan.angle_increment = 0.1;
  scan.range_max = 10.0;
  scan.ranges.assign(20, range);
  return scan;
}

TEST(ScanFreshness, blocks_before_the_first_scan_and_after_250_ms) {
  ScanFreshness freshness;
  EXPECT_TRUE(freshness.stale(0.0).has_value());
  freshness.seen(scan_with(1.0F), 1.0);
  EXPECT_FALSE(freshness.stale(1.249).has_value());
  EXPECT_TRUE(freshness.stale(1.251).has_value());
}

TEST(ScanFreshness, a_repeated_scan_and_an_empty_one_count_as_none) {
  ScanFreshness freshness;
  freshness.seen(scan_with(1.0F), 1.0);
  freshness.seen(scan_with(1.0F), 1.2);
  EXPECT_TRUE(freshness.stale(1.3).has_value());
  freshness.seen(scan_with(1.01F), 1.4);
  EXPECT_FALSE(freshness.stale(1.5).has_value());
  freshness.seen(scan_with(0.0F), 1.6);
  EXPECT_TRUE(freshness.stale(1.7).has_value());
}

TEST(EncoderFreshness, blocks_after_100_ms_of_silence) {
  EncoderFreshness freshness;
  EXPECT_TRUE(freshness.stale(0.0).has_value());
  freshness.seen({0.0, 1, 1, 0}, 0.0);
  EXPECT_FALSE(freshness.stale(0.099).has_value());
  EXPECT_TRUE(freshness.stale(0.101).has_value());
}

TEST(EncoderFreshness, a_turning_wheel_must_count_and_a_standing_one_need_not) {
  EncoderFreshness freshness;
  std::optional<std::string> stale;
  for (int i = 0; i < 60 && !stale; ++i) {
    const double now = 0.02 * i;
    freshness.commanded(1.0, 0.0, now);
    freshness.seen({now, std::int64_t{10} * i, 0, 0}, now);
    stale = freshness.stale(now);
  }
  EXPECT_FALSE(stale.has_value());
  for (int i = 60; i < 100 && !stale; ++i) {
    const double now = 0.02 * i;
    freshness.seen({now, 600, 0, 0}, now);
    stale = freshness.stale(now);
  }
  ASSERT_TRUE(stale.has_value());
  EXPECT_NE(stale->find("left"), std::string::npos);
}

/// Message about a robot that drives and turns steadily for a second, with a reading every `step` s.
std::optional<std::string> said_of(double v, double w, double step, const routines::Limits& limits = {}) {
  SpeedWatch watch(limits);
  for (double t = 0.0; t < 1.0; t += step) {
    watch.seen(t, {v * t, 0.0, w * t}, {v, w});
    if (auto said = watch.too_fast()) return said;
  }
  return std::nullopt;
}

TEST(SpeedWatch, holds_what_is_measured_to_the_limit_and_a_fifth) {
  for (const double step : {0.01, 0.02, 0.1}) {
    EXPECT_FALSE(said_of(0.37, 0.0, step)) << step;
    EXPECT_TRUE(said_of(0.39, 0.0, step)) << step;
    EXPECT_FALSE(said_of(-0.37, 0.0, step)) << step;
    EXPECT_TRUE(said_of(-0.39, 0.0, step)) << step;
    EXPECT_FALSE(said_of(0.0, 0.76, step)) << step;
    EXPECT_TRUE(said_of(0.0, -0.78, step)) << step;
    EXPECT_TRUE(said_of(std::nan(""), 0.0, step)) << step;
  }
}

TEST(SpeedWatch, holds_what_is_measured_to_the_command_beyond_the_lag_of_the_drive) {
  const auto said = [](const routines::Twist& made, const routines::Twist& commanded) {
    SpeedWatch watch({});
    std::optional<std::string> first;
    for (double t = 0.0; t < 1.0 && !first; t += 0.02) {
      watch.seen(t, {made.v * t, 0.0, made.w * t}, commanded);
      first = watch.too_fast();
    }
    return first.value_or("");
  };
  EXPECT_EQ(said({0.17, 0.0}, {0.1, 0.0}), "");
  EXPECT_NE(said({0.19, 0.0}, {0.1, 0.0}).find("0.10 m/s is commanded"), std::string::npos);
  EXPECT_EQ(said({0.376, 0.0}, {0.3, 0.0}), "") << "a fifth of the command, and a little";
  EXPECT_EQ(said({0.0, -0.3}, {0.0, -0.1}), "");
  EXPECT_NE(said({0.0, -0.35}, {0.0, -0.1}).find("0.10 rad/s is commanded"), std::string::npos);
  EXPECT_NE(said({0.1, 0.0}, {}), "") << "somebody pushes it";
}

TEST(SpeedWatch, lets_a_drive_follow_its_command_late) {
  SpeedWatch watch({});
  double x = 0.0;
  for (int i = 0; i < 100; ++i) {
    const double commanded = i < 50 ? 0.3 : 0.0, made = i < 50 ? 0.3 : std::max(0.0, 0.3 - 0.02 * (i - 50));
    x += 0.02 * made;
    watch.seen(0.02 * i, {x, 0.0, 0.0}, {commanded, 0.0});
    EXPECT_FALSE(watch.too_fast()) << i;
  }
}

// A speed is excused by a command of the last 0.5 s: the window of the measurement and the lag of a drive.
TEST(SpeedWatch, a_command_of_earlier_excuses_nothing) {
  SpeedWatch watch({});
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.02 * i, since = t - 1.0;  // s since the last command to move
    watch.seen(t, {0.2 * t, 0.0, 0.5 * t}, since <= 0.0 ? routines::Twist{0.2, 0.5} : routines::Twist{});
    if (since < 0.49) {
      EXPECT_FALSE(watch.too_fast()) << since;
    } else if (since > 0.51) {
      EXPECT_TRUE(watch.too_fast()) << since;
    }
  }
}

TEST(SpeedWatch, goes_by_the_limits_of_the_motion_and_never_beyond_the_caps) {
  EXPECT_TRUE(said_of(0.15, 0.0, 0.02, {.speed = 0.1}));
  EXPECT_FALSE(said_of(0.13, 0.0, 0.02, {.speed = 0.1}));
  EXPECT_TRUE(said_of(0.39, 0.0, 0.02, {.speed = 2.0}));
}

// A count too many in one reading is gone in the next.
TEST(SpeedWatch, a_single_reading_of_a_few_counts_too_many_is_no_speed) {
  SpeedWatch watch({});
  for (int i = 0; i < 50; ++i) {
    watch.seen(0.02 * i, {0.004 * i + (i == 30 ? 0.02 : 0.0), 0.0, 0.0}, {0.2, 0.0});
    EXPECT_FALSE(watch.too_fast()) << i;
  }
}

TEST(Envelope, of_a_straight_metre_is_1_3_m_and_half_as_long_again) {
  const auto preview = routines::preview(routines::straight_plan({}));
  const Envelope envelope = Envelope::of(preview);
  EXPECT_NEAR(envelope.reach, 1.3, 0.01);
  EXPECT_FALSE(envelope.violated({1.25, 0.0, 0.0}, 0.0, 5.0).has_value());
  EXPECT_TRUE(envelope.violated({1.35, 0.0, 0.0}, 0.0, 5.0).has_value());
  EXPECT_TRUE(envelope.violated({0.0, 0.0, 0.0}, 1.0, 5.0).has_value());
  EXPECT_TRUE(envelope.violated({0.0, 0.0, 0.0}, 0.0, 1.6 * preview.duration).has_value());
  EXPECT_TRUE(envelope.violated({std::nan(""), 0.0, 0.0}, 0.0, 0.0).has_value());
}

TEST(Envelope, is_as_wide_as_it_is_long) {
  const Envelope envelope{.reach = 1.3, .turn = 1.0, .time = 10.0};
  for (int deg = 0; deg < 360; deg += 15) {
    const double c = std::cos(deg * std::numbers::pi / 180.0), s = std::sin(deg * std::numbers::pi / 180.0);
    EXPECT_FALSE(envelope.violated({1.29 * c, 1.29 * s, 0.0}, 0.0, 1.0)) << deg;
    EXPECT_TRUE(envelope.violated({1.31 * c, 1.31 * s, 0.0}, 0.0, 1.0)) << deg;
  }
  for (const double side : {-1.0, 1.0}) {
    EXPECT_FALSE(envelope.violated({}, 0.99 * side, 1.0));
    EXPECT_TRUE(envelope.violated({}, 1.01 * side, 1.0));
  }
  EXPECT_FALSE(envelope.violated({}, 0.0, 9.9));
  EXPECT_TRUE(envelope.violated({}, 0.0, 10.1));
}

TEST(Envelope, of_one_full_turn_is_450_degrees) {
  const Envelope envelope = Envelope::of(routines::preview(routines::spin_plan({})));
  EXPECT_NEAR(envelope.turn, 450.0 * std::numbers::pi / 180.0, 0.05);
}

TEST(Disagreement, is_judged_after_a_tenth_of_a_metre_only) {
  EXPECT_FALSE(disagreement({0.09, 0.0, 0.0}, {0.0, 0.0, 0.0}).has_value());
  EXPECT_TRUE(disagreement({0.11, 0.0, 0.0}, {0.0, 0.0, 0.0}).has_value());
  EXPECT_FALSE(disagreement({1.0, 0.0, 0.0}, {0.95, 0.02, 0.0}).has_value());
  EXPECT_TRUE(disagreement({1.0, 0.0, 0.0}, {0.5, 0.0, 0.0}).has_value());
  EXPECT_TRUE(disagreement({0.0, 0.0, 0.0}, {0.5, 0.0, 0.0}).has_value());
}

// Else a lidar that sits 4 cm beside its stated place, which nobody knows before the calibration, stops it.
TEST(Disagreement, grants_a_lidar_that_sits_elsewhere_what_a_turn_makes_of_that) {
  const routines::Pose odometry{-0.012, -0.062, -1.1};
  EXPECT_FALSE(disagreement(odometry, {-0.005, -0.111, -1.1}).has_value());
  EXPECT_TRUE(disagreement(odometry, {0.0, -0.171, -1.1}).has_value());
  EXPECT_TRUE(disagreement({0.1, 0.0, 0.0}, {0.16, 0.0, 0.0}).has_value()) << "not in a straight line";
}

TEST(Disagreement, finds_swapped_sides_in_a_turn) {
  EXPECT_TRUE(disagreement({0.0, 0.0, 0.8}, {0.0, 0.0, -0.8}).has_value());
  EXPECT_FALSE(disagreement({0.0, 0.0, 0.8}, {0.0, 0.0, 0.75}).has_value());
}

std::vector<Point> cluster(double x, double y) { return {{x, y}, {x, y + 0.01}, {x, y - 0.01}}; }

TEST(Obstacle, stopping_distance_has_the_figure_of_the_rule) {
  ObstacleOptions options;
  options.reaction = 0.13;
  EXPECT_NEAR(stopping_distance(0.20, options), 0.066 + 0.30, 1e-3);
}

TEST(Obstacle, margin_limits_the_speed_with_a_watchdog_that_waits_long) {
  EXPECT_NEAR(fastest_with(2.0), 0.15, 1e-12);
  EXPECT_NEAR(fastest_with(1.0), 0.30, 1e-12);
  EXPECT_GT(fastest_with(0.2), routines::kCaps.speed);
}

TEST(Obstacle, stopping_distance_counts_the_period_of_the_lidar_as_it_is) {
  const auto reaction_at = [](double period, int late) {
    ObstacleGuard guard({});
    double t = 5.0;
    for (int i = 0; i < 30; ++i) guard.turned(t += i == late ? 1.5 * period : period);
    return guard.options().reaction;
  };
  EXPECT_NEAR(reaction_at(0.1, -1), 0.13, 1e-9) << "the figure of the rule is that of 10 Hz";
  EXPECT_NEAR(reaction_at(0.2, -1), 0.23, 1e-9);
  EXPECT_NEAR(reaction_at(0.025, -1), 0.055, 1e-9);
  EXPECT_NEAR(reaction_at(0.1, 28), 0.18, 1e-9) << "one turn was slower";
  EXPECT_NEAR(reaction_at(0.1, 5), 0.13, 1e-9) << "long ago";
  EXPECT_NEAR(ObstacleGuard({}).options().reaction, 0.28, 1e-9) << "not known yet";
}

/// A robot that follows its command `lag` s late and brakes with at most `deceleration`; 0.2 m/s, then a
/// stop.
double overrun_of(double lag, double deceleration, double from = 0.2) {
  Braking braking;
  braking.begins();
  constexpr double kStep = 0.01, kRamp = 0.5;
  std::deque<double> commands;
  double x = 0.0, command = 0.0, speed = 0.0;
  for (int i = 0; i < 800; ++i) {
    const double t = i * kStep;
    command = t < 4.0 ? std::min(from, command + kRamp * kStep) : std::max(0.0, command - kRamp * kStep);
    commands.push_back(command);
    const double late = commands.front();
    if (static_cast<double>(commands.size()) * kStep > lag) commands.pop_front();
    speed = std::max(late, speed - deceleration * kStep);
    if (late > speed) speed = late;
    x += speed * kStep;
    braking.seen(t, {x, 0.0, 0.0}, {command, 0.0});
  }
  return braking.overrun();
}

TEST(Braking, overrun_is_the_lag_of_the_drive_and_what_a_weaker_deceleration_adds) {
  EXPECT_NEAR(overrun_of(0.0, 10.0), 0.0, 0.011);
  EXPECT_NEAR(overrun_of(0.1, 10.0), 0.1, 0.011);
  // v / (2 a) for 0.25 m/s^2 instead of 0.5: 0.4 s instead of 0.2 s.
  EXPECT_NEAR(overrun_of(0.0, 0.25), 0.2, 0.011);
  EXPECT_EQ(overrun_of(0.1, 10.0, 0.05), 0.0) << "a creep";
}

TEST(Braking, the_longest_of_the_last_ten_stops_counts) {
  Braking braking;
  double t = 0.0, x = 0.0;
  const auto go = [&](double speed, double commanded, double seconds) {
    for (const double end = t + seconds - 1e-9; t < end;) {
      t += 0.01;
      x += 0.01 * speed;
      braking.seen(t, {x, 0.0, 0.0}, {commanded, 0.0});
    }
  };
  const auto stop = [&](double lag) {
    go(0.2, 0.2, 0.5);
    go(0.2, 0.0, lag);
    go(0.0, 0.0, 0.3);
  };
  stop(0.3);
  EXPECT_NEAR(braking.overrun(), 0.3, 0.011);
  for (int later = 1; later <= 9; ++later) {
    stop(0.1);
    EXPECT_NEAR(braking.overrun(), 0.3, 0.011) << later;
  }
  stop(0.1);
  EXPECT_NEAR(braking.overrun(), 0.1, 0.011) << "long ago";
}

TEST(Braking, neither_a_slower_move_nor_a_turn_on_the_spot_is_a_stop) {
  Braking braking;
  double x = 0.0;
  for (int i = 0; i < 400; ++i) {
    const double command = i < 200 ? 0.2 : 0.1;
    x += 1.05 * command * 0.01;  // 5 % faster than commanded, all the time
    braking.seen(0.01 * i, {x, 0.0, 0.0}, {command, 0.0});
  }
  for (int i = 400; i < 450; ++i) braking.seen(0.01 * i, {x, 0.0, 0.0}, {0.0, 0.5});
  EXPECT_LT(braking.overrun(), 0.02);
}

TEST(Braking, what_rolled_on_after_a_motion_was_broken_off_is_no_stop_of_the_next_one) {
  Braking braking;
  for (int i = 0; i < 100; ++i) braking.seen(0.01 * i, {0.002 * i, 0.0, 0.0}, {0.2, 0.0});
  braking.begins();
  for (int i = 200; i < 260; ++i) braking.seen(0.01 * i, {0.4, 0.0, 0.0}, {0.0, 0.0});
  EXPECT_EQ(braking.overrun(), 0.0);
}

TEST(Obstacle, stopping_distance_counts_the_drive_as_it_brakes) {
  ObstacleGuard guard{{}};
  const double before = stopping_distance(0.2, guard.options());
  guard.brakes(0.2);
  EXPECT_NEAR(stopping_distance(0.2, guard.options()), before + 0.04, 1e-9);
  const auto beyond =
      cluster(0.25 + 0.05 + before + 0.02, 0.0);  // footprint and its margin, then the way to rest
  ObstacleGuard quick{{}};
  quick.seen(beyond, {0.2, 0.0});
  guard.seen(beyond, {0.2, 0.0});
  EXPECT_FALSE(quick.blocked());
  EXPECT_TRUE(guard.blocked());
}

TEST(Obstacle, says_where_the_nearest_of_it_is) {
  ObstacleGuard guard{{}};
  EXPECT_FALSE(guard.obstacle());
  guard.seen(cluster(0.5, -0.1), {0.2, 0.0});
  EXPECT_NE(guard.obstacle().value_or("").find("0.50 m ahead and 0.09"), std::string::npos)
      << *guard.obstacle();
  EXPECT_NE(guard.obstacle().value_or("").find("right"), std::string::npos) << *guard.obstacle();
}

TEST(ClearSpace, reaches_as_far_as_the_way_and_names_what_is_nearest) {
  const auto preview = routines::preview(routines::straight_plan({}));  // a metre
  std::vector<Point> points = cluster(2.0, 0.0);
  points.push_back({0.0, 1.5});
  points.push_back({3.0, 1.4});  // beside the lane
  const ClearSpace space = clear_space(points, preview, {}, 0.3);
  EXPECT_NEAR(space.sides[0].needed, 1.55, 0.01);  // 1 m, half the robot, the clearance
  EXPECT_NEAR(space.sides[1].needed, 0.55, 0.01);
  EXPECT_NEAR(space.sides[2].needed, 0.55, 0.01);
  EXPECT_NEAR(space.sides[3].needed, 0.55, 0.01);
  EXPECT_NEAR(space.sides[0].nearest.value_or(0.0), 2.0, 0.02);
  EXPECT_NEAR(space.sides[1].nearest.value_or(0.0), 1.5, 1e-9);
  EXPECT_FALSE(space.sides[2].nearest);
}

TEST(ClearSpace, map_shows_robot_way_and_readings_where_they_are) {
  const auto preview = routines::preview(routines::straight_plan({}));
  const ClearSpace space = clear_space({{0.8, 0.3}}, preview, {}, 0.3);
  EXPECT_NEAR(space.cell, 0.1, 1e-9);
  // From 1.85 m ahead to 0.85 m behind, 0.85 m to either side.
  ASSERT_EQ(space.rows.size(), 19U + 9U + 1U);
  ASSERT_EQ(space.rows[0].size(), 9U + 9U + 1U);
  const auto at = [&](double x, double y) {
    return space.rows[static_cast<std::size_t>(19 - std::lround(10.0 * x))]
                     [static_cast<std::size_t>(9 - std::lround(10.0 * y))];
  };
  EXPECT_EQ(at(0.0, 0.0), 'R');
  EXPECT_EQ(at(0.8, 0.3), '#');
  EXPECT_EQ(at(0.8, -0.3), '.');
  EXPECT_EQ(at(1.7, 0.0), ' ');
  EXPECT_EQ(at(0.0, 0.7), ' ');
}

TEST(ClearSpace, of_a_long_way_has_coarse_cells) {
  routines::StraightOptions far;
  far.distance = 5.0;
  const ClearSpace space = clear_space({}, routines::preview(routines::straight_plan(far)), {}, 0.3);
  EXPECT_GT(space.cell, 0.1);
  EXPECT_LT(space.rows.size(), 50U);
}

// The farthest to the right is neither the last place nor opposite the farthest to the left.
TEST(ClearSpace, of_a_way_to_the_side_is_as_wide_as_the_way) {
  routines::Preview preview;
  preview.path = {{0.0, 0.0, 0.0}, {0.0, -5.0, 0.0}, {0.0, 0.5, 0.0}};
  const ClearSpace space = clear_space({}, preview, {}, 0.3);
  EXPECT_NEAR(space.sides[0].needed, 0.55, 1e-9);
  EXPECT_NEAR(space.sides[1].needed, 1.05, 1e-9);
  EXPECT_NEAR(space.sides[2].needed, 0.55, 1e-9);
  EXPECT_NEAR(space.sides[3].needed, 5.55, 1e-9);
  EXPECT_NEAR(space.cell, (1.05 + 5.55) / 40.0, 1e-9);
}

TEST(Obstacle, ahead_counts_when_driving_ahead_and_not_when_backing) {
  const ObstacleOptions options;
  EXPECT_EQ(in_way(cluster(0.5, 0.0), {0.2, 0.0}, options).size(), 3U);
  EXPECT_EQ(in_way(cluster(0.5, 0.0), {-0.2, 0.0}, options).size(), 0U);
  EXPECT_EQ(in_way(cluster(-0.5, 0.0), {-0.2, 0.0}, options).size(), 3U);
  EXPECT_EQ(in_way(cluster(0.5, 0.5), {0.2, 0.0}, options).size(), 0U);
  EXPECT_EQ(in_way(cluster(1.5, 0.0), {0.2, 0.0}, options).size(), 0U);
  EXPECT_EQ(in_way(cluster(0.5, 0.0), {0.0, 0.0}, options).size(), 0U);
}

TEST(Obstacle, a_spin_watches_the_full_circle_from_its_first_step) {
  const ObstacleOptions options;
  for (int i = 0; i < 36; ++i) {
    const double angle = i * std::numbers::pi / 18.0;
    const double near = options.footprint.radius() + 0.03;
    const double far = options.footprint.radius() + 0.10;
    EXPECT_EQ(in_way({{near * std::cos(angle), near * std::sin(angle)}}, {0.0, 0.1}, options).size(), 1U)
        << i;
    EXPECT_EQ(in_way({{far * std::cos(angle), far * std::sin(angle)}}, {0.0, 0.1}, options).size(), 0U) << i;
  }
}

TEST(Obstacle, an_arc_looks_into_its_bend) {
  const ObstacleOptions options;
  EXPECT_FALSE(in_way(cluster(0.55, 0.38), {0.3, 0.6}, options).empty());
  EXPECT_EQ(in_way(cluster(0.55, 0.38), {0.3, -0.6}, options).size(), 0U);
}

TEST(Obstacle, one_scan_triggers_and_five_release) {
  ObstacleGuard guard{{}};
  guard.seen({{0.5, 0.0}, {0.5, 0.01}}, {0.2, 0.0});
  EXPECT_FALSE(guard.blocked());
  guard.seen(cluster(0.5, 0.0), {0.2, 0.0});
  EXPECT_TRUE(guard.blocked());
  for (int i = 0; i < 4; ++i) guard.seen({}, {0.2, 0.0});
  EXPECT_TRUE(guard.blocked());
  guard.seen({}, {0.2, 0.0});
  EXPECT_FALSE(guard.blocked());
}

TEST(Obstacle, the_way_is_checked_before_the_first_step) {
  const auto preview = routines::preview(routines::straight_plan({}));
  EXPECT_TRUE(occupied(cluster(1.4, 0.0), preview, {}, 0.3).has_value());
  EXPECT_FALSE(occupied(cluster(1.7, 0.0), preview, {}, 0.3).has_value());
  EXPECT_FALSE(occupied(cluster(0.5, 0.7), preview, {}, 0.3).has_value());
}

/// Beams every degree, from -half to half of `view`, that all end at the same range; 0: nowhere.
Scan fan(double view, float range) {
  Scan scan;
  scan.range_max = 10.0;
  scan.angle_min = -0.5 * view;
  scan.angle_increment = std::numbers::pi / 180.0;
  scan.ranges.assign(static_cast<std::size_t>(view / scan.angle_increment) + 1, range);
  return scan;
}

BlindArea blind_of(const Scan& scan, const std::array<double, 3>& pose = {}) {
  Cover cover;
  cover.seen(scan, pose, {}, 1.0);
  return cover.blind(1.0);
}

constexpr double kTurn = 2.0 * std::numbers::pi;

TEST(Cover, what_stands_behind_a_lidar_of_270_degrees_is_hidden) {
  const auto blind = blind_of(fan(0.75 * kTurn, 5.0F));
  EXPECT_TRUE(blind.hides({-0.26, 0.0}));
  EXPECT_FALSE(blind.hides({0.26, 0.0}));
  EXPECT_FALSE(blind.hides({-0.26, 0.35}));
  ASSERT_EQ(blind.sectors().size(), 1U);
  EXPECT_NEAR(blind.sectors()[0].from, 0.375 * kTurn, 0.06);
  EXPECT_NEAR(blind.sectors()[0].to, 0.625 * kTurn, 0.06);
  EXPECT_NE(text_of(blind.sectors()).find("deg"), std::string::npos);
}

// One bin that is seen is enough between two blind sectors, wherever it is; a sector over 0 is one.
TEST(BlindArea, has_a_sector_on_either_side_of_what_is_seen) {
  constexpr std::size_t kBins = BlindArea::kBins;
  constexpr double kBin = kTurn / kBins;
  for (std::size_t middle = 0; middle < kBins; ++middle) {
    BlindArea::Bins blind{};
    for (std::size_t k = 1; k <= 3; ++k)
      blind.at((middle + k) % kBins) = blind.at((middle + kBins - k) % kBins) = true;
    const auto sectors = BlindArea({}, blind).sectors();
    ASSERT_EQ(sectors.size(), 2U) << middle;
    for (const Sector& sector : sectors) EXPECT_NEAR(sector.to - sector.from, 3.0 * kBin, 1e-9) << middle;
    blind.at(middle) = true;
    const auto one = BlindArea({}, blind).sectors();
    ASSERT_EQ(one.size(), 1U) << middle;
    EXPECT_NEAR(one[0].to - one[0].from, 7.0 * kBin, 1e-9) << middle;
  }
}

TEST(Cover, a_beam_without_an_echo_sees_and_one_that_ends_on_the_robot_does_not) {
  EXPECT_TRUE(blind_of(fan(kTurn, 0.0F)).sectors().empty());
  EXPECT_EQ(blind_of(fan(kTurn, 0.2F)).sectors().size(), 1U);
  EXPECT_TRUE(blind_of(fan(kTurn, 0.2F)).hides({1.0, 0.0}));
}

TEST(Cover, one_lost_echo_in_the_shadow_of_the_robot_opens_no_view) {
  Cover cover;
  cover.seen(fan(kTurn, 0.2F), {}, {}, 1.0);
  cover.seen(fan(kTurn, 0.0F), {}, {}, 1.1);
  EXPECT_EQ(cover.blind(1.1).sectors().size(), 1U);
}

TEST(Cover, is_remembered_for_a_second_and_thin_posts_and_coarse_beams_are_no_gaps) {
  Cover cover;
  cover.seen(fan(kTurn, 5.0F), {}, {}, 1.0);
  EXPECT_TRUE(cover.blind(1.9).sectors().empty());
  EXPECT_EQ(cover.blind(2.1).sectors().size(), 1U);
  Scan coarse = fan(kTurn, 5.0F);
  coarse.angle_increment *= 3.0;
  coarse.ranges.resize(120);
  coarse.ranges[60] = 0.1F;
  EXPECT_TRUE(blind_of(coarse).sectors().empty());
}

TEST(Cover, turns_with_the_mount_and_is_seen_from_where_the_lidar_is) {
  const auto blind = blind_of(fan(0.5 * kTurn, 5.0F), {0.2, 0.0, std::numbers::pi / 2.0});
  EXPECT_FALSE(blind.hides({0.2, 1.0}));
  EXPECT_TRUE(blind.hides({0.2, -1.0}));
  EXPECT_TRUE(blind.hides({0.3, -0.1}));
}

TEST(UnseenMoves, are_those_backward_and_on_the_spot_of_a_lidar_that_looks_ahead) {
  const auto ahead = blind_of(fan(0.75 * kTurn, 5.0F));
  using Names = std::vector<std::string>;
  EXPECT_EQ(unseen_moves(routines::straight_plan({}), ahead, {}), Names{"straight backward"});
  EXPECT_EQ(unseen_moves(routines::spin_plan({}), ahead, {}), (Names{"spin left", "spin right"}));
  EXPECT_EQ(unseen_moves({"", {routines::turn_to(1.0, 0.4)}, {}}, ahead, {}), Names{"turn to heading"});
  EXPECT_EQ(unseen_moves({"", {routines::arc(0.5, 1.0, 0.3, false)}, {}}, ahead, {}),
            Names{"left arc backward"});
  const auto around = blind_of(fan(kTurn, 5.0F));
  EXPECT_TRUE(unseen_moves(routines::straight_plan({}), around, {}).empty());
  EXPECT_TRUE(unseen_moves(routines::spin_plan({}), around, {}).empty());
}

TEST(PreviewedPath, is_bounded_by_the_way_however_often_it_is_driven) {
  routines::SpinOptions options;
  const auto once = routines::preview(routines::spin_plan(options)).path;
  options.turns = 3.0;
  options.repeat = 4;
  const auto often = routines::preview(routines::spin_plan(options)).path;
  EXPECT_GT(once.size(), 60U);
  EXPECT_LT(often.size(), once.size() + 10U);
}

TEST(PointsOf, turns_the_scan_into_the_base_frame_and_drops_no_readings) {
  Scan scan;
  scan.range_max = 10.0;
  scan.angle_increment = std::numbers::pi / 2.0;
  scan.ranges = {1.0F, 0.0F, 2.0F, 20.0F};
  const auto points = points_of(scan, {0.1, 0.0, std::numbers::pi / 2.0});
  ASSERT_EQ(points.size(), 2U);
  EXPECT_NEAR(points[0].x, 0.1, 1e-6);
  EXPECT_NEAR(points[0].y, 1.0, 1e-6);
  EXPECT_NEAR(points[1].y, -2.0, 1e-6);
}

class AskedLease : public ::testing::Test {
 protected:
  void SetUp() override { id_ = value_of(lease_.acquire(1, 0.0)); }
  // The daemon looks every 10 ms, and the last time at `end`.
  void look(double begin, double end) {
    for (double t = begin; t < end; t += 0.010) lease_.looked(t);
    lease_.looked(end);
  }
  Lease lease_;
  std::string id_;
};

TEST_F(AskedLease, lapses_without_renewal_and_cannot_be_revived) {
  look(0.0, 0.1);
  EXPECT_TRUE(lease_.renew(id_, 0.1).ok());
  look(0.1, 0.1 + kLeaseTime - 0.001);
  EXPECT_TRUE(lease_.holds(id_));
  look(0.1 + kLeaseTime - 0.001, 0.1 + kLeaseTime + 0.001);
  EXPECT_FALSE(lease_.holds(id_));
  EXPECT_FALSE(lease_.renew(id_, 0.5).ok());
}

TEST_F(AskedLease, belongs_to_one_client_and_ends_with_its_connection) {
  EXPECT_FALSE(lease_.acquire(2, 0.1).ok());
  EXPECT_FALSE(lease_.renew("wrong", 0.1).ok());
  lease_.lost(2);
  EXPECT_TRUE(lease_.active());
  lease_.lost(1);
  EXPECT_FALSE(lease_.active());
  EXPECT_TRUE(lease_.acquire(2, 0.1).ok());
}

TEST_F(AskedLease, is_released_by_its_own_name_alone_and_others_are_told) {
  const auto foreign = lease_.release("wrong");
  ASSERT_FALSE(foreign.ok());
  EXPECT_EQ(foreign.error().code, ErrorCode::not_permitted);
  EXPECT_FALSE(lease_.release("").ok());
  EXPECT_TRUE(lease_.holds(id_));
  EXPECT_TRUE(lease_.release(id_).ok());
  EXPECT_FALSE(lease_.active());
  EXPECT_FALSE(lease_.release(id_).ok()) << "twice";
  EXPECT_FALSE(lease_.release("").ok()) << "there is none";
}

TEST_F(AskedLease, outlives_a_daemon_that_reads_late_what_had_arrived) {
  look(0.0, 0.05);
  ASSERT_TRUE(lease_.renew(id_, 0.25, 0.23).ok());
  lease_.looked(0.25);
  EXPECT_TRUE(lease_.holds(id_));
  EXPECT_NEAR(lease_.age(0.25), 0.02, 1e-9);
  look(0.25, 0.34);
  EXPECT_TRUE(lease_.holds(id_)) << "110 ms after it was sent";
  look(0.34, 0.36);
  EXPECT_FALSE(lease_.holds(id_)) << "130 ms after it was sent, however late it was read";
}

// A pause of the whole machine: the daemon wakes first, and nothing has been sent meanwhile.
TEST_F(AskedLease, gives_a_client_that_was_held_up_with_the_daemon_time_to_speak) {
  look(0.0, 0.05);
  lease_.looked(0.05 + 0.15);
  EXPECT_TRUE(lease_.holds(id_));
  look(0.20, 0.20 + kSecondChance - 0.001);
  EXPECT_TRUE(lease_.renew(id_, 0.259).ok());
  look(0.26, 0.35);
  EXPECT_TRUE(lease_.holds(id_));
}

TEST_F(AskedLease, is_not_kept_by_the_daemons_own_delay_for_long) {
  look(0.0, 0.05);
  lease_.looked(0.20);
  look(0.20, 0.20 + kSecondChance + 0.001);
  EXPECT_FALSE(lease_.holds(id_));
}

TEST_F(AskedLease, does_not_outlive_the_longest_silence_however_often_the_daemon_is_late) {
  double t = 0.0;
  for (; t <= kLongestSilence; t += 0.05) lease_.looked(t);
  lease_.looked(t);
  EXPECT_FALSE(lease_.holds(id_));
}

TEST_F(AskedLease, takes_no_time_of_sending_that_cannot_be) {
  ASSERT_TRUE(lease_.renew(id_, 0.1, 1e9).ok());
  EXPECT_NEAR(lease_.age(0.1), 0.0, 1e-9);
  ASSERT_TRUE(lease_.renew(id_, 0.12, -1e9).ok());
  EXPECT_NEAR(lease_.age(0.12), 0.02, 1e-9);
  ASSERT_TRUE(lease_.renew(id_, 0.13, std::nan("")).ok());
  EXPECT_NEAR(lease_.age(0.13), 0.0, 1e-9);
}

TEST(StopGuard, stops_once_on_every_way_out) {
  int stops = 0;
  {
    StopGuard guard([&stops] { ++stops; });
    guard.stop();
  }
  EXPECT_EQ(stops, 1);
  try {
    const StopGuard guard([&stops] { ++stops; });
    throw std::runtime_error("anything");
  } catch (const std::runtime_error&) {
    EXPECT_EQ(stops, 2);
  }
}

}  // namespace
}  // namespace odomcalib::safety::safety_test
