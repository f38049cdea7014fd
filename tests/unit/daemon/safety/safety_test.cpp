#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "daemon/routines/plans.hpp"
#include "daemon/safety/cover.hpp"
#include "daemon/safety/envelope.hpp"
#include "daemon/safety/freshness.hpp"
#include "daemon/safety/lease.hpp"
#include "daemon/safety/obstacle.hpp"
#include "daemon/safety/speed_watch.hpp"
#include "daemon/safety/stop_guard.hpp"

namespace odomcalib::safety {
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

/// What is said of a robot that drives and turns steadily for a second, with a reading every `step` s.
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

TEST(SpeedWatch, goes_by_the_limits_of_the_motion_and_never_beyond_the_caps) {
  EXPECT_TRUE(said_of(0.15, 0.0, 0.02, {.speed = 0.1}));
  EXPECT_FALSE(said_of(0.13, 0.0, 0.02, {.speed = 0.1}));
  EXPECT_TRUE(said_of(0.39, 0.0, 0.02, {.speed = 2.0}));
}

// What was a count too many in one reading is not in the next.
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

TEST(Obstacle, ahead_counts_when_driving_ahead_and_not_when_backing) {
  const ObstacleOptions options;
  EXPECT_EQ(points_in_way(cluster(0.5, 0.0), {0.2, 0.0}, options), 3);
  EXPECT_EQ(points_in_way(cluster(0.5, 0.0), {-0.2, 0.0}, options), 0);
  EXPECT_EQ(points_in_way(cluster(-0.5, 0.0), {-0.2, 0.0}, options), 3);
  EXPECT_EQ(points_in_way(cluster(0.5, 0.5), {0.2, 0.0}, options), 0);
  EXPECT_EQ(points_in_way(cluster(1.5, 0.0), {0.2, 0.0}, options), 0);
  EXPECT_EQ(points_in_way(cluster(0.5, 0.0), {0.0, 0.0}, options), 0);
}

TEST(Obstacle, a_spin_watches_the_full_circle_from_its_first_step) {
  const ObstacleOptions options;
  for (int i = 0; i < 36; ++i) {
    const double angle = i * std::numbers::pi / 18.0;
    const double near = options.footprint.radius() + 0.03;
    const double far = options.footprint.radius() + 0.10;
    EXPECT_EQ(points_in_way({{near * std::cos(angle), near * std::sin(angle)}}, {0.0, 0.1}, options), 1) << i;
    EXPECT_EQ(points_in_way({{far * std::cos(angle), far * std::sin(angle)}}, {0.0, 0.1}, options), 0) << i;
  }
}

TEST(Obstacle, an_arc_looks_into_its_bend) {
  const ObstacleOptions options;
  EXPECT_GT(points_in_way(cluster(0.55, 0.38), {0.3, 0.6}, options), 0);
  EXPECT_EQ(points_in_way(cluster(0.55, 0.38), {0.3, -0.6}, options), 0);
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

TEST(DistinctPoses, are_bounded_by_the_way_however_often_it_is_driven) {
  routines::SpinOptions options;
  const auto once = distinct_poses(routines::preview(routines::spin_plan(options)));
  options.turns = 3.0;
  options.repeat = 4;
  const auto often = distinct_poses(routines::preview(routines::spin_plan(options)));
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
  void SetUp() override {
    const auto given = lease_.acquire(1, 0.0);
    ASSERT_TRUE(given.ok());
    id_ = given.value();
  }
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
}  // namespace odomcalib::safety
