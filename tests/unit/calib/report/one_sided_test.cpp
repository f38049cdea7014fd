// A large part of a drive that only the counts tell of, or only the scans, is said.
#include "calib/report/one_sided.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "calib/report/left_out.hpp"

namespace odomcalib::calib::report::one_sided_test {
namespace {

/// Counts every 0.02 s and scans every 0.1 s of a drive of 100 s that never stands.
Recording whole_drive() {
  Recording recording;
  for (int k = 0; k <= 5000; ++k) recording.ticks.push_back({0.02 * k, 30 * k, 40 * k});
  for (int k = 0; k <= 1000; ++k) {
    Scan scan;
    scan.t = 0.1 * k;
    recording.scans.push_back(scan);
  }
  return recording;
}

template <typename Sample>
void cut_out(std::vector<Sample>& samples, double begin, double end) {
  std::erase_if(samples, [&](const Sample& sample) { return sample.t > begin && sample.t < end; });
}

/// Only one finding, of about so many samples.
void expect_one(const std::vector<Discarded>& all, const std::string& what, const std::string& reason,
                double count, double by) {
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all.front().what, what);
  EXPECT_EQ(all.front().reason, reason);
  EXPECT_NEAR(static_cast<double>(all.front().count), count, by);
}

TEST(OneSided, is_nothing_of_a_whole_drive) { EXPECT_TRUE(one_sided(whole_drive()).empty()); }

TEST(OneSided, are_scans_without_counts) {
  Recording recording = whole_drive();
  cut_out(recording.ticks, 30.0, 70.0);
  expect_one(one_sided(recording), "scan", "no counts at that time", 400.0, 2.0);
  const auto losses = losses_of({&recording, 1});
  ASSERT_EQ(losses.size(), 1U);
  EXPECT_NEAR(losses.front().share, 0.4, 0.01);
  EXPECT_FALSE(losses.front().of_wheels);
}

TEST(OneSided, are_scans_before_the_first_count_and_after_the_last) {
  Recording recording = whole_drive();
  cut_out(recording.ticks, -1.0, 15.0);
  cut_out(recording.ticks, 85.0, 101.0);
  ASSERT_EQ(one_sided(recording).size(), 1U);
  EXPECT_NEAR(static_cast<double>(one_sided(recording).front().count), 300.0, 4.0);
}

TEST(OneSided, are_counts_without_scans) {
  Recording recording = whole_drive();
  cut_out(recording.scans, 30.0, 70.0);
  expect_one(one_sided(recording), "counts", "no scans at that time", 2000.0, 5.0);
}

TEST(OneSided, is_no_part_that_is_small) {
  Recording recording = whole_drive();
  cut_out(recording.ticks, 30.0, 45.0);
  cut_out(recording.scans, 60.0, 75.0);
  EXPECT_TRUE(one_sided(recording).empty());
}

TEST(OneSided, is_no_robot_that_stands_and_sends_nothing) {
  Recording recording = whole_drive();
  for (TickSample& tick : recording.ticks) {
    const double moving = std::min(tick.t, 30.0) + std::max(0.0, tick.t - 70.0);
    tick.left = std::llround(1500.0 * moving), tick.right = std::llround(2000.0 * moving);
  }
  cut_out(recording.ticks, 30.1, 69.9);
  EXPECT_TRUE(one_sided(recording).empty());
}

}  // namespace
}  // namespace odomcalib::calib::report::one_sided_test
