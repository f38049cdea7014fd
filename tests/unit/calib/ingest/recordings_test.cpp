// Recordings as a value, and scans that may be sweeps.
#include "calib/ingest/recordings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "calib/ingest/sweeps.hpp"
#include "calib/math/se2.hpp"

namespace odomcalib::calib::ingest::recordings_test {
namespace {

constexpr unsigned kSeed = 7;

/// A steady drive whose ticks were sampled every 20 ms and stamped late by up to `jitter`, s.
Recording steady_drive(double jitter) {
  std::mt19937 engine(kSeed);
  std::uniform_real_distribution<double> late(0.0, 1.0);
  Recording recording;
  for (std::int64_t k = 0; k < 2000; ++k)
    recording.ticks.push_back({0.02 * static_cast<double>(k) + jitter * late(engine), 100 * k, 101 * k, 0});
  return recording;
}

std::vector<Recording> scanned(std::optional<double> time_increment) {
  Recording recording;
  for (int k = 0; k < 10; ++k) {
    Scan scan;
    scan.t = 0.1 * k;
    scan.angle_min = -3.0F;
    scan.angle_increment = 0.1F;
    scan.time_increment = time_increment;
    scan.ranges.assign(60, 1.0F);
    recording.scans.push_back(scan);
  }
  return {recording};
}

TEST(Recordings, a_copy_is_of_the_same_recordings_and_a_repaired_one_is_not) {
  const std::vector<Recording> given(2);
  const Recordings one(given), repaired({given.begin(), given.end()}, {});
  const std::vector<Recordings> copies(2, one);
  EXPECT_TRUE(copies.back().are_those_of(one));
  EXPECT_TRUE(Recordings(repaired).are_those_of(repaired));
  EXPECT_FALSE(repaired.are_those_of(one));
  EXPECT_FALSE(Recordings{}.are_those_of(one));
}

TEST(Recordings, outlive_the_value_that_they_came_from) {
  Recordings kept;
  {
    const Recordings repaired({Recording{}}, {});
    kept = repaired;
  }
  EXPECT_EQ(kept.size(), 1U);
  EXPECT_TRUE(kept.front().ticks.empty());
}

TEST(Recordings, uneven_ticks_are_evened_out_and_reported_and_those_given_stay) {
  const std::vector<Recording> given{steady_drive(0.0), steady_drive(8e-3)};
  const double stamp = given[1].ticks[100].t;
  const Recordings even = with_even_ticks(given);
  ASSERT_EQ(even.size(), 2U) << "seed " << kSeed;
  EXPECT_GT(even.stamps().ticks, 1e-3);
  EXPECT_FALSE(even.are_those_of(Recordings(given)));
  EXPECT_EQ(even[0].ticks[100].t, given[0].ticks[100].t);
  EXPECT_NE(even[1].ticks[100].t, stamp);
  EXPECT_EQ(given[1].ticks[100].t, stamp);
}

TEST(Recordings, even_ticks_are_not_copied) {
  const std::vector<Recording> given{steady_drive(0.0)};
  const Recordings even = with_even_ticks(given);
  EXPECT_TRUE(even.are_those_of(Recordings(given)));
  EXPECT_FALSE(even.stamps().any());
}

TEST(Sweeps, a_head_that_turns_once_a_scan_is_reported) {
  const std::vector<Recording> given = scanned(std::nullopt);
  const auto sweeping = with_sweeps(Recordings(given));
  ASSERT_TRUE(sweeping);
  EXPECT_NEAR(sweeping->stamps().turn, 0.1, 1e-6);
  EXPECT_NEAR(sweeping->stamps().sweep, 0.1 * 0.1 / (2.0 * math::kPi), 1e-6);
  EXPECT_EQ(sweeping->front().scans[0].time_increment, sweeping->stamps().sweep);
  EXPECT_FALSE(given.front().scans[0].time_increment);
}

TEST(Sweeps, beams_in_one_direction_turn_no_head) {
  std::vector<Recording> given = scanned(std::nullopt);
  for (Scan& scan : given.front().scans) scan.angle_increment = 0.0;
  const auto sweeping = with_sweeps(Recordings(given));
  ASSERT_TRUE(sweeping);
  EXPECT_EQ(sweeping->stamps().turn, 0.0);
  EXPECT_EQ(sweeping->stamps().sweep, 0.0);
}

TEST(Sweeps, stated_times_of_beams_are_believed) {
  const std::vector<Recording> given = scanned(1e-4);
  EXPECT_FALSE(with_sweeps(Recordings(given)));
  EXPECT_FALSE(with_sweeps(Recordings(scanned(std::nullopt)), SweepKind::instead_of_stated));
}

TEST(Sweeps, a_head_that_turns_once_a_scan_may_stand_against_stated_times) {
  const double half = 0.5 * 0.1 * 0.1 / (2.0 * math::kPi);
  const auto sweeping = with_sweeps(Recordings(scanned(half)), SweepKind::instead_of_stated);
  ASSERT_TRUE(sweeping);
  EXPECT_NEAR(sweeping->stamps().turn, 0.05, 1e-6);
  EXPECT_NEAR(*sweeping->front().scans[0].time_increment, 2.0 * half, 1e-9);
}

TEST(Sweeps, beams_that_are_sent_against_their_list_are_listed_as_they_are_sent) {
  const double increment = 0.1 * 0.1 / (2.0 * math::kPi);
  for (const auto& stated : {std::optional(increment), std::optional<double>()}) {
    std::vector<Recording> given = scanned(stated);
    given.front().scans[3].ranges[7] = 2.0F;
    const auto sweeping = with_sweeps(Recordings(given), SweepKind::against_the_list);
    ASSERT_TRUE(sweeping);
    const Scan &before = given.front().scans[3], &after = sweeping->front().scans[3];
    EXPECT_EQ(after.ranges[59 - 7], 2.0F);
    EXPECT_NEAR(after.angle(59 - 7), before.angle(7), 1e-9);
    EXPECT_EQ(after.t, before.t);
    EXPECT_NEAR(*after.time_increment, increment, 1e-9);
    EXPECT_NEAR(sweeping->stamps().turn, stated ? -0.2 : -0.1, 1e-6);
  }
}

TEST(Sweeps, a_stamp_in_the_middle_moves_by_half_a_scan) {
  const std::vector<Recording> given = scanned(std::nullopt);
  const auto sweeping = with_sweeps(Recordings(given));
  ASSERT_TRUE(sweeping);
  const Recordings moved = stamped_in_the_middle(*sweeping);
  const double middle = 0.5 * 59.0 * sweeping->stamps().sweep;
  EXPECT_NEAR(sweeping->front().scans[5].t - moved.front().scans[5].t, middle, sweeping->stamps().sweep);
  EXPECT_EQ(moved.stamps().turn, sweeping->stamps().turn);
}

}  // namespace
}  // namespace odomcalib::calib::ingest::recordings_test
