// Standing counts that are a broken encoder, and after how long; and those that are not.
#include "drivers/base/motion/stuck_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

namespace odomcalib::drivers::stuck_watch_test {
namespace {

/// A wheel by its angle over time, read every so often, and the speed it is told.
struct Ride {
  std::function<double(double)> angle;                                    // rad at time s
  std::function<double(double)> told = [](double /*t*/) { return 2.7; };  // rad/s
  double ticks_per_rev = 4096.0, reading_s = 0.010, duration = 3.0;
};

/// s of the first alarm, if there is one.
std::optional<double> alarm(const Ride& ride) {
  constexpr double kStep = 0.002;
  StuckWatch watch(ride.ticks_per_rev);
  watch.begin(0.0);
  double due = 0.0;
  for (double t = 0.0; t < ride.duration; t += kStep) {
    if (t >= due) {
      const double ticks = ride.angle(t) / (2.0 * std::numbers::pi) * ride.ticks_per_rev;
      watch.counted(static_cast<std::int64_t>(std::floor(ticks)), t, t + 0.001);
      due += ride.reading_s;
    }
    watch.commanded(ride.told(t), t + 0.001);
    if (watch.stuck(t + 0.001)) return t;
  }
  return std::nullopt;
}

/// Turns at a speed, but for a time in which it stands.
std::function<double(double)> with_stop(double rate, double from, double to) {
  return [=](double t) { return rate * (std::min(t, from) + std::max(0.0, t - to)); };
}

constexpr double kNever = 1e9;

TEST(StuckWatch, a_wheel_that_was_turning_is_found_within_100_ms) {
  for (const double freezes : {0.2, 0.5, 1.0, 2.003})
    for (const double rate : {0.5, 1.0, 2.7, 8.0}) {
      const auto found =
          alarm({.angle = with_stop(rate, freezes, kNever), .told = [=](double) { return rate; }});
      ASSERT_TRUE(found.has_value()) << freezes << " s, " << rate << " rad/s";
      const bool had_left = rate * freezes > 0.16;  // else it may still be breaking away
      EXPECT_LT(*found - freezes, had_left ? 0.100 : 0.5) << freezes << " s, " << rate << " rad/s";
      EXPECT_GT(*found - freezes, 0.070);
    }
}

TEST(StuckWatch, a_wheel_that_never_leaves_is_found_after_300_ms) {
  const auto found = alarm({.angle = [](double) { return 0.0; }});
  ASSERT_TRUE(found.has_value());
  EXPECT_GT(*found, 0.3);
  EXPECT_LT(*found, 0.33);
}

TEST(StuckWatch, a_slow_start_and_play_in_the_gear_are_no_fault) {
  EXPECT_FALSE(alarm({.angle = [](double t) { return 2.7 * std::max(0.0, t - 0.28); }}));
  // 2 degrees of play, 0.25 s of friction, then it turns.
  EXPECT_FALSE(
      alarm({.angle = [](double t) { return std::min(2.7 * t, 0.035) + 2.7 * std::max(0.0, t - 0.27); }}));
  // A slow drive: 0.2 rad/s^2.
  EXPECT_FALSE(alarm({.angle = [](double t) { return 0.1 * t * t; }}));
}

TEST(StuckWatch, a_short_stall_is_no_fault_and_a_longer_one_is) {
  for (const double begins : {0.5, 0.503, 1.0}) {
    EXPECT_FALSE(alarm({.angle = with_stop(2.7, begins, begins + 0.055)})) << begins;
    EXPECT_TRUE(alarm({.angle = with_stop(2.7, begins, begins + 0.12)})) << begins;
  }
}

TEST(StuckWatch, low_speeds_and_coarse_counts_are_judged_by_what_they_should_give) {
  // 64 counts a turn: one in 36 ms at 2.7 rad/s, one in 200 ms at 0.5 rad/s.
  for (const double rate : {0.5, 1.0, 2.7}) {
    const auto told = [=](double) { return rate; };
    EXPECT_FALSE(alarm({.angle = with_stop(rate, kNever, kNever), .told = told, .ticks_per_rev = 64.0}));
    const auto found = alarm({.angle = with_stop(rate, 1.5, kNever), .told = told, .ticks_per_rev = 64.0});
    ASSERT_TRUE(found.has_value()) << rate;
    EXPECT_LT(*found - 1.5, 0.65) << rate;  // three counts at the lowest speed, or 300 ms
  }
  EXPECT_FALSE(alarm({.angle = [](double t) { return 0.01 * t; }, .told = [](double) { return 0.01; }}));
}

TEST(StuckWatch, turning_round_with_a_slow_ramp_is_no_fault) {
  // Told to go back at 1 s; the drive needs two seconds and stands for a moment.
  const auto angle = [](double t) { return t < 1.0 ? t : 1.0 + (t - 1.0) - 0.5 * (t - 1.0) * (t - 1.0); };
  const auto told = [](double t) { return t < 1.0 ? 1.0 : -1.0; };
  EXPECT_FALSE(alarm({.angle = angle, .told = told}));
  EXPECT_FALSE(alarm({.angle = angle, .told = told, .ticks_per_rev = 512.0}));
}

TEST(StuckWatch, coming_to_rest_as_told_is_no_fault) {
  const auto told = [](double t) { return std::max(0.0, 2.7 - std::max(0.0, t - 1.0) * 2.7); };
  // The wheel follows, but stands 0.1 s before the command is zero.
  const auto angle = [](double t) {
    const double ramp = std::clamp(t - 1.0, 0.0, 0.9);
    return 2.7 * (std::min(t, 1.0) + ramp - 0.5 * ramp * ramp);
  };
  EXPECT_FALSE(alarm({.angle = angle, .told = told}));
}

TEST(StuckWatch, a_drive_that_refreshes_its_counts_slowly_is_known_by_its_pauses) {
  for (const double refresh : {0.05, 0.07}) {
    const auto stepped = [=](double rate, double until) {
      return [=](double t) { return rate * refresh * std::floor(std::min(t, until) / refresh); };
    };
    EXPECT_FALSE(alarm({.angle = stepped(2.7, kNever)})) << refresh;
    const auto found = alarm({.angle = stepped(2.7, 1.5)});
    ASSERT_TRUE(found.has_value()) << refresh;
    EXPECT_LT(*found - 1.5, 0.2) << refresh;
  }
  // Readings every 100 ms: three of them decide.
  EXPECT_FALSE(alarm({.angle = with_stop(2.7, kNever, kNever), .reading_s = 0.1}));
  const auto found = alarm({.angle = with_stop(2.7, 1.5, kNever), .reading_s = 0.1});
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(*found - 1.5, 0.42);
}

TEST(StuckWatch, a_gap_in_the_readings_is_no_standing_count) {
  StuckWatch watch(4096.0);
  watch.begin(0.0);
  double t = 0.0;
  const auto ride = [&](double until) {
    for (; t < until; t += 0.01) {
      watch.commanded(2.7, t);
      watch.counted(std::llround(t * 2.7 * 4096.0 / (2.0 * std::numbers::pi)), t, t);
      ASSERT_FALSE(watch.stuck(t)) << t;
    }
  };
  ride(1.0);
  t += 0.2;  // the host was held up; the wheel went on
  watch.commanded(2.7, t);
  EXPECT_FALSE(watch.stuck(t));
  ride(2.0);
}

}  // namespace
}  // namespace odomcalib::drivers::stuck_watch_test
