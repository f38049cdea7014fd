#include "calib/wheels/wheel_track.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace odomcalib::calib::wheels::fine_track_test {
namespace {

/// Stands for 1 s, speeds up at 8 rad/s^2 for 1 s, goes on, slows down, stands.
double angle_at(double t) {
  constexpr double kRate = 8.0;
  if (t < 1.0) return 0.0;
  if (t < 2.0) return 0.5 * kRate * (t - 1.0) * (t - 1.0);
  if (t < 4.0) return 0.5 * kRate + kRate * (t - 2.0);
  if (t < 5.0) return 2.5 * kRate + kRate * (t - 4.0) - 0.5 * kRate * (t - 4.0) * (t - 4.0);
  return 3.0 * kRate;
}

WheelTrack sampled_every(double period) {
  WheelTrack track;
  for (int k = 0; k * period < 6.0; ++k) {
    track.t.push_back(k * period);
    track.left.push_back(angle_at(k * period));
    track.right.push_back(-angle_at(k * period));
    track.segment.push_back(0);
  }
  return track;
}

double at(const WheelTrack& track, double t) {
  const std::size_t k = track.interval_at(t);
  const double share = (t - track.t[k]) / (track.t[k + 1] - track.t[k]);
  return track.left[k] + share * (track.left[k + 1] - track.left[k]);
}

double rms_error(const WheelTrack& track) {
  double sum = 0.0, count = 0.0;
  for (double t = 0.0; t < 5.8; t += 0.003, count += 1.0) sum += std::pow(at(track, t) - angle_at(t), 2);
  return std::sqrt(sum / count);
}

TEST(FineTrack, SD_02_follows_a_wheel_that_speeds_up_between_rare_ticks) {
  const WheelTrack rare = sampled_every(0.1), fine = finely_sampled(rare);
  EXPECT_LT(rms_error(fine), 0.2 * rms_error(rare));
  for (std::size_t k = 0; k < rare.t.size(); ++k) EXPECT_NEAR(at(fine, rare.t[k]), rare.left[k], 1e-9);
  for (std::size_t k = 1; k < fine.t.size(); ++k) {
    EXPECT_GT(fine.t[k], fine.t[k - 1]);
    EXPECT_LT(fine.t[k] - fine.t[k - 1], 0.031);
    EXPECT_EQ(fine.right[k], -fine.left[k]);
  }
}

TEST(FineTrack, a_wheel_that_stands_does_not_move) {
  const WheelTrack fine = finely_sampled(sampled_every(0.1));
  for (const double t : {0.03, 0.5, 0.87, 5.13, 5.6}) {
    const std::size_t k = fine.interval_at(t);
    EXPECT_EQ(fine.left[k], fine.left[k + 1]) << t;
  }
}

/// Counts of an encoder, as a recording has them.
WheelTrack counted_every(double period) {
  constexpr double kCount = 2.0 * std::numbers::pi / 8000.0;
  WheelTrack track = sampled_every(period);
  track.tick_angle = kCount;
  for (auto* angles : {&track.left, &track.right})
    for (double& angle : *angles) angle = kCount * std::round(4273.0 + angle / kCount);
  return track;
}

TEST(FineTrack, goes_beyond_no_sample) {
  const WheelTrack rare = counted_every(0.04), fine = finely_sampled(rare);
  for (std::size_t k = 0; k + 1 < fine.t.size(); ++k) {
    const std::size_t own = rare.interval_at(fine.t[k]);
    EXPECT_GE(fine.left[k], rare.left[own]) << fine.t[k];
    EXPECT_LE(fine.left[k], rare.left[own + 1]) << fine.t[k];
  }
}

TEST(FineTrack, frequent_ticks_stay_as_they_are) {
  const WheelTrack track = sampled_every(0.02), same = finely_sampled(track);
  EXPECT_EQ(same.t, track.t);
  EXPECT_EQ(same.left, track.left);
}

TEST(FineTrack, nothing_is_made_up_in_gaps_and_across_segments) {
  WheelTrack track = sampled_every(0.1);
  for (std::size_t k = 30; k < track.t.size(); ++k) track.t[k] += 3.0;
  for (std::size_t k = 40; k < track.t.size(); ++k) track.segment[k] = 1;
  const WheelTrack fine = finely_sampled(track);
  const auto inside = [&](double from, double to) {
    return std::count_if(fine.t.begin(), fine.t.end(), [&](double t) { return t > from && t < to; });
  };
  EXPECT_EQ(inside(track.t[29], track.t[30]), 0);
  EXPECT_EQ(inside(track.t[39], track.t[40]), 0);
  EXPECT_GT(inside(track.t[38], track.t[39]), 0);
}

/// Whether motion is known between two times.
bool is_whole(const WheelTrack& track, double from, double to) {
  return finely_sampled(track).covers(from, to);
}

WheelTrack without(WheelTrack track, double from, double to) {
  for (std::size_t k = track.t.size(); k-- > 0;) {
    if (track.t[k] < from || track.t[k] > to) continue;
    const auto at = static_cast<std::ptrdiff_t>(k);
    for (auto* values : {&track.t, &track.left, &track.right}) values->erase(values->begin() + at);
    track.segment.erase(track.segment.begin() + at);
  }
  return track;
}

TEST(FineTrack, motion_is_unknown_where_counts_are_missing_while_a_wheel_turns) {
  const WheelTrack track = counted_every(0.02);
  EXPECT_TRUE(is_whole(track, 0.1, 5.5));
  EXPECT_FALSE(is_whole(without(track, 2.5, 3.5), 2.4, 3.6));
  EXPECT_FALSE(is_whole(without(track, 2.5, 3.5), 0.1, 5.5));
  EXPECT_TRUE(is_whole(without(track, 2.5, 3.5), 0.1, 2.4));
  EXPECT_TRUE(is_whole(without(track, 2.5, 3.5), 3.6, 5.5));
  EXPECT_TRUE(is_whole(without(track, 2.5, 2.9), 2.4, 3.6)) << "a few messages";
}

TEST(FineTrack, a_wheel_that_stands_may_be_silent) {
  EXPECT_TRUE(is_whole(without(counted_every(0.02), 0.1, 0.95), 0.05, 1.5));
}

TEST(FineTrack, rare_counts_are_no_gaps) {
  EXPECT_TRUE(is_whole(counted_every(0.6), 0.1, 5.0));
  EXPECT_FALSE(is_whole(without(counted_every(0.6), 2.3, 3.5), 0.1, 5.0)) << "two are missing";
}

TEST(FineTrack, pauses_between_bursts_are_no_gaps) {
  WheelTrack bursts = counted_every(0.02);
  for (double t = 0.09; t < 6.0; t += 0.7) bursts = without(bursts, t, t + 0.6);
  EXPECT_TRUE(is_whole(bursts, 0.05, 5.0));
}

TEST(FineTrack, few_samples_stay_as_they_are) {
  WheelTrack track = sampled_every(0.1);
  for (auto* values : {&track.t, &track.left, &track.right}) values->resize(3);
  track.segment.resize(3);
  EXPECT_EQ(finely_sampled(track).t, track.t);
  EXPECT_TRUE(finely_sampled(WheelTrack{}).t.empty());
}

}  // namespace
}  // namespace odomcalib::calib::wheels::fine_track_test
