#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "calib/vehicle/drive_history.hpp"
#include "calib/vehicle/drive_model.hpp"
#include "calib/vehicle/step_context.hpp"

namespace odomcalib::calib::vehicle::step_context_test {
namespace {

constexpr double kPeriod = 0.01;  // s
constexpr double kSpeed = 0.2;    // m/s
const wheels::BaseParameters kBase{0.075, 0.075, 0.4, {}};

/// A drive of legs, each with a constant speed of either rim.
struct Leg {
  double left = 0.0, right = 0.0;  ///< m/s
  double duration = 0.0;           ///< s
};

DriveContext contexts_of(const std::vector<Leg>& legs) {
  wheels::WheelTrack track{{0.0}, {0.0}, {0.0}, {0}};
  for (const Leg& leg : legs)
    for (int k = 0; k < static_cast<int>(std::round(leg.duration / kPeriod)); ++k) {
      track.t.push_back(track.t.back() + kPeriod);
      track.left.push_back(track.left.back() + leg.left * kPeriod / kBase.left_radius);
      track.right.push_back(track.right.back() + leg.right * kPeriod / kBase.right_radius);
      track.segment.push_back(0);
    }
  return make_context(track, kBase);
}

/// Contexts of a left wheel that shows `counts` one after the other.
DriveContext contexts_of_counts(const std::vector<int>& counts) {
  wheels::WheelTrack track;
  track.tick_angle = 0.01;
  for (const int count : counts) {
    track.t.push_back(kPeriod * static_cast<double>(track.t.size()));
    track.left.push_back(track.tick_angle * count);
    track.right.push_back(0.0);
    track.segment.push_back(0);
  }
  return make_context(track, kBase);
}

TEST(Reversal, is_more_than_a_count) {
  const auto contexts = contexts_of_counts({0, 5, 10, 9, 10, 9, 10, 15, 20});
  for (const StepContext& c : contexts) EXPECT_GT(c.left_since_reversal, 100.0) << c.t;
}

TEST(Reversal, counts_from_where_the_wheel_turned) {
  const auto contexts = contexts_of_counts({0, 5, 10, 9, 7, 2, -3});
  EXPECT_GT(contexts[2].left_since_reversal, 100.0);
  EXPECT_EQ(contexts[3].left_since_reversal, 0.0);
  EXPECT_NEAR(contexts[5].left_since_reversal, 0.07, 1e-12);
}

/// Loss to a play of 0.05 rad, in each interval.
std::vector<double> lost_of_counts(const std::vector<int>& counts) {
  const auto play = static_cast<std::size_t>(std::find(kPlays.begin(), kPlays.end(), 0.05) - kPlays.begin());
  std::vector<double> lost;
  const DriveContext contexts = contexts_of_counts(counts);
  for (const StepContext& c : contexts) lost.push_back(c.lost_to_play().left.at(play));
  return lost;
}

TEST(Play, is_lost_once_after_each_reversal) {
  const std::vector<double> expected = {0.0, 0.0, 0.0, -0.03, -0.02, 0.0, 0.05, 0.0};
  const std::vector<double> lost = lost_of_counts({0, 10, 20, 30, 27, 20, 10, 20, 30});
  ASSERT_EQ(lost.size(), expected.size());
  for (std::size_t k = 0; k < lost.size(); ++k) EXPECT_NEAR(lost[k], expected[k], 1e-12) << k;
}

TEST(Play, loses_no_more_than_there_and_back_within_it) {
  const std::vector<double> expected = {0.0, -0.03, 0.02, 0.01, 0.0};
  const std::vector<double> lost = lost_of_counts({0, 30, 27, 29, 35, 45});
  ASSERT_EQ(lost.size(), expected.size());
  for (std::size_t k = 0; k < lost.size(); ++k) EXPECT_NEAR(lost[k], expected[k], 1e-12) << k;
}

TEST(Play, of_less_than_a_count_loses_its_share_of_what_is_no_dither) {
  const auto contexts = contexts_of_counts({0, 5, 10, 9, 10, 5});
  EXPECT_EQ(contexts[2].lost_to_play().left.front() + contexts[3].lost_to_play().left.front(), 0.0)
      << "a count to and fro";
  EXPECT_NEAR(contexts[4].lost_to_play().left.front(), -kPlays.front(), 1e-12);
}

TEST(Reversal, needs_no_fast_start) {
  const auto contexts = contexts_of_counts({0, 1, 2, 3, 2, 1, 0});
  EXPECT_GT(contexts[3].left_since_reversal, 100.0);
  EXPECT_EQ(contexts[4].left_since_reversal, 0.0);
}

TEST(Reversal, ends_where_a_wheel_dithers_at_rest) {
  const auto contexts = contexts_of_counts({0, 10, 5, 0, 1, 0, 1, 0, 1, 0});
  EXPECT_NEAR(contexts[8].left_since_reversal, contexts[3].left_since_reversal, 1e-12);
}

TEST(OnDemand, is_what_a_running_drive_sees_and_the_same_again_after_it_was_forgotten) {
  const DriveContext drive =
      contexts_of({{kSpeed, kSpeed, 2.0}, {-kSpeed, 0.5 * kSpeed, 2.0}, {0.1, 0.2, 1.0}});
  for (int time = 0; time < 2; ++time) {
    DriveHistory history(kBase, 0.0);
    std::size_t lost = 0, swings = 0;
    for (const StepContext& c : drive) {
      StepContext running = c;
      history.advance(running);
      ASSERT_EQ(c.lost_to_play().left, running.lost_to_play().left) << c.t;
      ASSERT_EQ(c.lost_to_play().right, running.lost_to_play().right) << c.t;
      ASSERT_EQ(c.caster(), running.caster()) << c.t;
      lost += c.lost_to_play().left != LostToPlay{} ? 1 : 0;
      swings += c.caster() != CasterSines{} ? 1 : 0;
    }
    EXPECT_GT(lost, 0U);
    EXPECT_GT(swings, 0U);
    drive.forget_on_demand();
  }
}

std::size_t caster(std::size_t trail, double lean) {
  const auto place = std::find(kCasterLeans.begin(), kCasterLeans.end(), lean);
  return trail * kCasterLeans.size() + static_cast<std::size_t>(place - kCasterLeans.begin());
}

/// Sine of the caster's angle summed over the way of the leg that begins at sample `first`, in trails.
double swing_of(const DriveContext& contexts, std::size_t first, std::size_t which) {
  double push = 0.0;
  for (std::size_t k = first; k < contexts.size(); ++k)
    push += contexts[k].caster()[which] * kSpeed * kPeriod / kCasterTrails[which / kCasterLeans.size()];
  return push;
}

TEST(Caster, falls_off_its_lean_and_turns_through_half_a_circle) {
  const auto contexts = contexts_of({{kSpeed, kSpeed, 5.0}, {-kSpeed, -kSpeed, 5.0}});
  for (std::size_t trail = 0; trail < kCasterTrails.size(); ++trail)
    for (const double lean : {-0.01, -0.002, 0.002, 0.01}) {
      const std::size_t which = caster(trail, lean);
      EXPECT_NEAR(contexts[480].caster()[which], lean, 0.1 * std::abs(lean)) << trail;
      // Once reversed, it points past its way by the lean less half a turn. The integral of sin(beta) ds / t
      // is that of -dbeta: half a turn, and what the lean adds on the way.
      EXPECT_NEAR(swing_of(contexts, 500, which), -std::copysign(std::numbers::pi, lean), 0.8) << trail;
    }
}

TEST(Caster, stands_on_its_head_after_a_straight_when_nothing_tips_it) {
  const auto contexts = contexts_of({{kSpeed, kSpeed, 2.0}, {-kSpeed, -kSpeed, 0.05}});
  EXPECT_NEAR(contexts.back().caster()[caster(0, 0.0)], 0.0, 1e-12);
}

TEST(Caster, falls_inwards_after_an_arc) {
  for (const double side : {-1.0, 1.0}) {
    const double more = side * 0.02;
    const auto contexts = contexts_of({{kSpeed - more, kSpeed + more, 5.0}, {-kSpeed, -kSpeed, 5.0}});
    EXPECT_GT(std::abs(swing_of(contexts, 500, caster(2, 0.0))), 2.5);
    EXPECT_EQ(std::signbit(swing_of(contexts, 500, caster(2, 0.0))), std::signbit(side));
    // A lean far smaller than the arc's angle does not change the side.
    EXPECT_EQ(std::signbit(swing_of(contexts, 500, caster(2, 0.002))), std::signbit(side));
    EXPECT_EQ(std::signbit(swing_of(contexts, 500, caster(2, -0.002))), std::signbit(side));
  }
}

TEST(Sway, comes_late_by_its_lag) {
  constexpr double kAcceleration = 1.5;  // rad/s^2
  std::vector<Leg> legs = {{0.0, 0.0, 1.0}};
  for (double t = 0.0; t < 2.0; t += kPeriod) {
    const double rim = 0.5 * kAcceleration * t * kBase.track_width;
    legs.push_back({-rim, rim, kPeriod});
  }
  const auto contexts = contexts_of(legs);
  for (std::size_t k = 0; k < kSwayLags.size(); ++k) {
    double missing = 0.0;  // what a first-order lag never makes up for: lag times acceleration
    for (std::size_t i = 0; i + 20 < contexts.size(); ++i) {
      missing +=
          (contexts[i].turn_acceleration_after[kUsualMemory] - contexts[i].turn_acceleration_after[k]) *
          contexts[i].dt;
      EXPECT_EQ(contexts[i + 1].turn_acceleration_before[k], contexts[i].turn_acceleration_after[k]);
    }
    EXPECT_NEAR(missing, kSwayLags[k] * kAcceleration, 0.01 * kAcceleration) << kSwayLags[k];
  }
}

TEST(RelaxedTurnRate, follows_over_its_way_and_has_the_sign_of_the_force) {
  constexpr double kTurn = 0.5;  // rad/s
  const double half = 0.5 * kTurn * kBase.track_width;
  const auto contexts = contexts_of(
      {{kSpeed, kSpeed, 3.0}, {kSpeed - half, kSpeed + half, 5.0}, {-kSpeed - half, -kSpeed + half, 5.0}});
  for (std::size_t k = 0; k < kRelaxations.size(); ++k) {
    const auto after = static_cast<std::size_t>(std::round(kRelaxations[k] / (kSpeed * kPeriod)));
    // Smoothing over a quarter of a second blurs the beginning of the turn.
    EXPECT_NEAR(contexts[300 + after].relaxed_turn_rate[k], kTurn * (1.0 - std::exp(-1.0)), 0.1 * kTurn) << k;
    EXPECT_NEAR(contexts[790].relaxed_turn_rate[k], kTurn, 0.01 * kTurn) << k;
    EXPECT_NEAR(contexts[1290].relaxed_turn_rate[k], -kTurn, 0.01 * kTurn) << k;
  }
}

/// Both wheels for eight seconds.
/// @param rate of the wheels, rad/s, at a time
template <typename Rate>
wheels::WheelTrack driven_at(Rate rate) {
  wheels::WheelTrack track;
  double angle = 0.0;
  for (int k = 0; k <= 400; ++k) {
    const double t = 0.02 * k;
    angle += 0.02 * rate(t);
    track.t.push_back(t);
    track.left.push_back(angle);
    track.right.push_back(angle);
    track.segment.push_back(0);
  }
  return track;
}

TEST(StepContext, remembers_the_last_push_through_steady_motion) {
  wheels::WheelTrack track;
  double angle = 0.0, rate = 0.0;
  for (int k = 0; k <= 400; ++k) {  // speeds up for 1 s, goes on steadily, slows down for 0.5 s, goes on
    const double t = 0.02 * k;
    const double acceleration = t < 1.0 ? 5.0 : t > 4.0 && t < 4.5 ? -5.0 : 0.0;
    rate += 0.02 * acceleration;
    angle += 0.02 * rate;
    track.t.push_back(t);
    track.left.push_back(angle);
    track.right.push_back(angle);
    track.segment.push_back(0);
  }
  const auto context = make_context(track, kBase);
  EXPECT_EQ(context.front().previous_acceleration[kUsualMemory], 0.0);
  EXPECT_GT(context[190].previous_acceleration[kUsualMemory], 0.8);
  EXPECT_LT(context[350].previous_acceleration[kUsualMemory], -0.5);
  const double reached = 5.0 * kBase.left_radius;
  for (std::size_t k = 0; k < kAccelerationThresholds.size(); ++k) {
    const double stays = kAccelerationThresholds[k] < reached ? 1.0 : 0.0;
    EXPECT_EQ(context[190].previous_acceleration[kMemorySpans.size() + k], stays)
        << kAccelerationThresholds[k];
    EXPECT_EQ(context.back().previous_acceleration[kMemorySpans.size() + k], -stays)
        << kAccelerationThresholds[k];
  }
}

// Else the threshold would be found by when an acceleration passed it, not by which accelerations did.
TEST(StepContext, an_acceleration_moves_a_seat_when_it_begins_whatever_the_threshold) {
  const wheels::WheelTrack track =
      driven_at([](double t) {  // 0.6 m/s^2 are reached in half a second, and left again
        const double along = std::clamp((t - 4.0) / 0.5, 0.0, 2.0);
        return 1.0 + 4.0 * (along < 1.0 ? 0.5 * along * along : 1.0 - 0.5 * std::pow(2.0 - along, 2));
      });
  const auto context = make_context(track, kBase);
  const auto moved_at = [&](std::size_t threshold) {
    const auto is_moved = [&](const StepContext& c) {
      return c.previous_acceleration[kMemorySpans.size() + threshold] > 0.0;
    };
    return std::find_if(context.begin(), context.end(), is_moved) - context.begin();
  };
  EXPECT_NEAR(static_cast<double>(moved_at(0)), 205.0, 5.0);
  for (std::size_t k = 1; kAccelerationThresholds[k] < 0.5; ++k)
    EXPECT_EQ(moved_at(k), moved_at(0)) << kAccelerationThresholds[k];
  EXPECT_EQ(static_cast<std::size_t>(moved_at(kAccelerationThresholds.size() - 1)), context.size());
}

TEST(StepContext, what_a_motion_has_wound_up_unwinds_once_in_the_stop_after_it) {
  wheels::WheelTrack track = driven_at([](double t) { return t < 4.0 || (t > 5.0 && t < 5.01) ? 5.0 : 0.0; });
  const auto sums = [](const DriveContext& context, std::size_t winding) {
    ReleasedWinding sum;
    for (const StepContext& c : context) {
      sum.way += c.unwound.at(winding).way;
      sum.turn += c.unwound.at(winding).turn;
    }
    return sum;
  };
  const auto straight = make_context(track, kBase);
  for (double& angle : track.left) angle = -angle;
  const auto turn = make_context(track, kBase);
  for (std::size_t winding = 0; winding < kWindings; ++winding) {
    EXPECT_NEAR(sums(straight, winding).way, 1.0, 0.15);
    EXPECT_NEAR(sums(straight, winding).turn, 0.0, 1e-9);
    EXPECT_NEAR(sums(turn, winding).turn, 1.0, 0.15);
  }
  EXPECT_NEAR(sums(turn, 0).way, 0.0, 1e-9);
  EXPECT_EQ(straight[150].unwound[0].way, 0.0);  // in motion
  EXPECT_NEAR(straight[240].fastest, 5.0 * kBase.left_radius, 1e-3);
}

TEST(StepContext, counts_from_stops_that_last) {
  const wheels::WheelTrack track =
      driven_at([](double t) { return (t > 4.0 && t < 4.31) || (t > 6.0 && t < 6.11) ? 0.0 : 5.0; });
  const auto since = make_context(track, kBase).back().since_stop;
  const double step = 0.1 * kBase.left_radius;
  for (std::size_t k = 0; k < kStops.size(); ++k) {
    if (kStops[k] > 0.3) {
      EXPECT_GT(since[k], 100.0) << kStops[k];
    } else if (kStops[k] < 0.25) {  // a sudden start is seen an interval early, a sudden stop late
      EXPECT_NEAR(since[k], 179.0 * step, 2.0 * step) << kStops[k];
    }
  }
}

// The last counts of a robot that comes to rest ever more slowly, or that rocks, came anywhere in the stop.
TEST(StepContext, tells_stops_of_different_lengths_however_the_robot_comes_to_rest) {
  constexpr double kCount = 0.002;  // rad
  const auto measured = [&](double stop, double phase) {
    wheels::WheelTrack track = driven_at([&](double t) {
      return t < 4.0 ? 5.0 : t < 4.2 + stop ? 5.0 * std::exp((4.0 - t) / 0.03) : 5.0;
    });
    for (auto* wheel : {&track.left, &track.right})
      for (double& angle : *wheel) angle = kCount * std::floor(angle / kCount + phase);
    for (std::size_t k = 212; k < 214; ++k) track.left[k] += kCount;
    track.tick_angle = kCount;
    const auto since = make_context(track, kBase).back().since_stop;
    return std::count_if(since.begin(), since.end(), [](double s) { return s < 100.0; });
  };
  std::ptrdiff_t before = 0;
  for (const double stop : {0.14, 0.21, 0.28, 0.35}) {
    std::vector<std::ptrdiff_t> counts;
    for (const double phase : {0.0, 0.25, 0.5, 0.75}) counts.push_back(measured(stop, phase));
    const auto [least, most] = std::minmax_element(counts.begin(), counts.end());
    EXPECT_GT(*least, before) << stop;
    before = *most;
  }
}

}  // namespace
}  // namespace odomcalib::calib::vehicle::step_context_test
