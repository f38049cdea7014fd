// Stamps that are uneven: believed where the motion follows them, evened out where it does not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "calib/ingest/even_stamps.hpp"
#include "calib/ingest/recordings.hpp"
#include "calib/measurement/scan_stamps.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::ingest::stamps_test {
namespace {

constexpr double kPeriod = 0.02;  // s

std::vector<double> evenly(std::size_t count, double period = kPeriod) {
  std::vector<double> times;
  for (std::size_t k = 0; k < count; ++k) times.push_back(100.0 + period * static_cast<double>(k));
  return times;
}

/// Later by the absolute value of a normal error, in order.
std::vector<double> late(std::vector<double> times, double deviation) {
  std::mt19937 engine(selection::kSeed);
  std::normal_distribution<double> error(0.0, deviation);
  for (double& t : times) t += std::abs(error(engine));
  std::sort(times.begin(), times.end());
  return times;
}

/// Standard deviation of what lies between both, whose mean is a delay.
double spread(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    sum += a[k] - b[k];
    squares += std::pow(a[k] - b[k], 2);
  }
  const double count = static_cast<double>(a.size());
  return std::sqrt(squares / count - std::pow(sum / count, 2));
}

TEST(EvenStamps, nothing_to_do_where_they_are_even_or_few) {
  EXPECT_FALSE(even_stamps(evenly(1000)));
  EXPECT_FALSE(even_stamps(late(evenly(40), 3e-3)));
  EXPECT_FALSE(even_stamps({}));
  EXPECT_FALSE(even_stamps(std::vector<double>(100, 7.0))) << "a clock that stands";
}

TEST(EvenStamps, find_the_pace_under_jitter) {
  const auto truth = evenly(2000), given = late(truth, 3e-3);
  const auto even = even_stamps(given);
  ASSERT_TRUE(even);
  EXPECT_LT(spread(even->t, truth), 0.3 * spread(given, truth)) << "seed " << selection::kSeed;
  EXPECT_NEAR(even->jitter, spread(given, truth), 0.5e-3);
  EXPECT_TRUE(std::is_sorted(even->t.begin(), even->t.end()));
}

TEST(EvenStamps, are_in_order_from_the_first_on) {
  auto given = late(evenly(2000), 3e-3);
  given[0] += 3.0 * kPeriod;
  given[1] = given[2] = given[3] = given[0];
  std::sort(given.begin(), given.end());
  const auto even = even_stamps(given);
  ASSERT_TRUE(even);
  EXPECT_EQ(even->t.size(), given.size());
  EXPECT_TRUE(std::is_sorted(even->t.begin(), even->t.end())) << even->t[0] << " " << even->t[1];
}

// Two samples that were held up for a period come with the third, and the pace goes on from there.
TEST(EvenStamps, put_the_second_sample_not_before_the_first) {
  const auto truth = evenly(2000);
  auto given = late(truth, 3e-3);
  given[0] = given[1] = truth[1];
  given[2] = truth[1] + 0.9 * kPeriod;
  given[3] = truth[3] + 1e-3;
  ASSERT_TRUE(std::is_sorted(given.begin(), given.end()));
  const auto even = even_stamps(given);
  ASSERT_TRUE(even);
  EXPECT_LE(even->t[0], even->t[1]);
  EXPECT_TRUE(std::is_sorted(even->t.begin(), even->t.end()));
}

TEST(EvenStamps, keep_lost_samples_and_pauses) {
  std::vector<double> truth;
  std::mt19937 engine(selection::kSeed);
  for (std::size_t k = 0; k < 2000; ++k)
    if (engine() % 50 != 0) truth.push_back(evenly(2000)[k] + (k > 900 ? 0.513 : 0.0));
  const auto given = late(truth, 2e-3);
  const auto even = even_stamps(given);
  ASSERT_TRUE(even);
  EXPECT_LT(spread(even->t, truth), 0.6 * spread(given, truth)) << "seed " << selection::kSeed;
}

TEST(EvenStamps, count_what_was_held_up_once) {
  const auto truth = evenly(2000);
  std::vector<double> given = truth;
  for (std::size_t k = 10; k + 3 < given.size(); k += 25)  // 55 ms late, and the next two with it
    for (std::size_t j = 0; j < 3; ++j) given[k + j] = truth[k] + 0.055 + 1e-4 * static_cast<double>(j);
  const auto even = even_stamps(given);
  ASSERT_TRUE(even);
  EXPECT_LT(spread(even->t, truth), 0.02 * spread(given, truth));
}

/// One in fifty is stamped early, or late, by six tenths of a period; jitter beside that.
std::vector<double> now_and_then(std::vector<double> times, double share_of_period, double deviation) {
  std::mt19937 engine(selection::kSeed);
  std::normal_distribution<double> error(0.0, deviation);
  for (double& t : times) {
    t += error(engine);
    if (engine() % 50 == 0) t += share_of_period * kPeriod;
  }
  std::sort(times.begin(), times.end());
  return times;
}

TEST(EvenStamps, miss_no_sample_where_one_is_early_or_late_now_and_then) {
  const auto truth = evenly(3000);
  for (const double share : {-0.6, 0.6}) {
    const auto given = now_and_then(truth, share, 0.08 * kPeriod);
    const auto even = even_stamps(given);
    ASSERT_TRUE(even);
    EXPECT_LT(spread(even->t, truth), 0.03 * kPeriod) << share << ", seed " << selection::kSeed;
  }
}

TEST(EvenStamps, count_lost_samples_beside_early_and_late_ones) {
  std::vector<double> truth;
  std::mt19937 engine(selection::kSeed + 1);
  for (const double t : evenly(3000))
    if (engine() % 50 != 0) truth.push_back(t);
  for (const double share : {-0.6, 0.6}) {
    const auto even = even_stamps(now_and_then(truth, share, 0.04 * kPeriod));
    ASSERT_TRUE(even);
    EXPECT_LT(spread(even->t, truth), 0.03 * kPeriod) << share << ", seed " << selection::kSeed;
  }
}

TEST(EvenStamps, spread_what_arrives_in_bursts) {
  const auto truth = evenly(2000);
  std::vector<double> given;
  for (std::size_t k = 0; k < truth.size(); ++k)
    given.push_back(truth[k - k % 4 + 3] + 1e-4 * static_cast<double>(k % 4));
  const auto even = even_stamps(given);
  ASSERT_TRUE(even);
  EXPECT_LT(spread(even->t, truth), 0.1 * spread(given, truth));
}

TEST(StampComparison, goes_to_the_stamps_whose_errors_are_noise) {
  std::mt19937 engine(selection::kSeed);
  std::normal_distribution<double> noise;
  StampComparison for_even, for_given, undecided;
  for (int k = 0; k < 400; ++k) {
    const double own = noise(engine), difference = 0.7 * noise(engine);
    for_even.add(own + difference, own);
    for_given.add(own, own - difference);
    undecided.add(own + 0.5 * difference, own - 0.5 * difference);
  }
  EXPECT_TRUE(for_even.even_is_better()) << "seed " << selection::kSeed;
  EXPECT_FALSE(for_given.even_is_better());
  EXPECT_FALSE(undecided.even_is_better());
  EXPECT_FALSE(StampComparison().even_is_better());
}

/// Counts of wheels that speed up and slow down, taken at the given times.
Recording counted(const std::vector<double>& taken, const std::vector<double>& stamps) {
  Recording recording;
  recording.robot.ticks_per_rev = 4096.0;
  for (std::size_t k = 0; k < taken.size(); ++k) {
    const double t = taken[k];
    recording.ticks.push_back({stamps[k], std::llround(3000.0 * t + 4000.0 * std::sin(0.5 * t)),
                               std::llround(2000.0 * t + 3000.0 * std::sin(0.3 * t)), 0});
  }
  return recording;
}

TEST(EvenTicks, are_even_where_counts_grow_by_number_and_not_by_stamp) {
  const auto truth = evenly(3000), jittered = late(truth, 3e-3);
  const auto even = even_ticks(counted(truth, jittered));
  ASSERT_TRUE(even) << "seed " << selection::kSeed;
  EXPECT_LT(spread(even->t, truth), 0.3 * spread(jittered, truth));
  EXPECT_FALSE(even_ticks(counted(jittered, jittered))) << "taken when they are stamped";
  EXPECT_FALSE(even_ticks(counted(std::vector<double>(3000, 100.0), jittered))) << "standing still";
  EXPECT_FALSE(even_ticks(Recording{}));
}

// A driver sends three samples at a time, stamps the second as the first, and begins to count anew.
TEST(EvenTicks, are_even_where_the_second_of_three_bears_the_stamp_of_the_first) {
  const auto truth = evenly(3000);
  std::vector<double> stamps = truth;
  for (std::size_t k = 1; k < stamps.size(); k += 3) stamps[k] = stamps[k - 1];
  Recording recording = counted(truth, stamps);
  for (std::size_t k = 0; k < truth.size(); ++k)
    recording.ticks[k].segment = static_cast<std::int32_t>(k / 3);
  const auto even = even_ticks(recording);
  ASSERT_TRUE(even);
  EXPECT_LT(spread(even->t, truth), 0.1 * spread(stamps, truth));
}

TEST(EvenTicks, sent_twice_happened_once) {
  const auto truth = evenly(3000), jittered = late(truth, 3e-3);
  Recording recording = counted(truth, jittered);
  std::vector<TickSample> twice;
  for (std::size_t k = 0; k < recording.ticks.size(); ++k) {
    twice.push_back(recording.ticks[k]);
    if (k % 10 != 5) continue;
    twice.push_back(recording.ticks[k]);
    twice.back().t += 1e-6;
  }
  recording.ticks = twice;
  const auto even = even_ticks(recording);
  ASSERT_TRUE(even);
  ASSERT_EQ(even->t.size(), twice.size());
  EXPECT_EQ(even->t[5], even->t[6]);
  EXPECT_NEAR(even->t[1000 + 7] - even->t[1000 + 5], kPeriod, 1e-3) << "one of the three is a repeat";
}

std::vector<vehicle::Interval> between(const std::vector<double>& times) {
  std::vector<vehicle::Interval> intervals;
  for (std::size_t k = 0; k + 1 < times.size(); ++k) intervals.push_back({times[k], times[k + 1]});
  return intervals;
}

/// Scans stamped as given; motions are those between the times at which they were taken.
measurement::FitData scanned(const vehicle::DriveModel& model, const std::vector<double>& taken,
                             const std::vector<double>& stamps, Recording& recording) {
  recording.scans.resize(stamps.size());
  set_stamps(recording.scans, stamps);
  measurement::FitData data = selection::measured(model, {}, {}, between(taken));
  const std::vector<vehicle::Interval> stamped = between(stamps);
  for (std::size_t k = 0; k < stamped.size(); ++k) data.pairs[k].interval = stamped[k];
  return data;
}

TEST(EvenScans, are_even_where_motion_says_so) {
  const vehicle::DriveModel model = selection::lively_model();
  std::vector<double> truth;
  for (double t = 2.0; t < 238.0; t += 0.5) truth.push_back(t);
  const auto jittered = late(truth, 15e-3);
  Recording recording;
  const measurement::FitData data = scanned(model, truth, jittered, recording);
  const auto even = even_scans(recording, data, {}, vehicle::to_vector(selection::kBase));
  ASSERT_TRUE(even) << "seed " << selection::kSeed;
  EXPECT_LT(spread(even->t, truth), 0.4 * spread(jittered, truth));
  const measurement::FitData right = scanned(model, jittered, jittered, recording);
  EXPECT_FALSE(even_scans(recording, right, {}, vehicle::to_vector(selection::kBase)))
      << "taken when they are stamped";
}

TEST(StampReport, remarks_on_what_a_driver_could_mend) {
  EXPECT_FALSE(StampReport{}.any());
  EXPECT_TRUE(remarks_on({4e-3, 4e-3, 0.0}).empty());
  const auto remarks = remarks_on({0.0, 16e-3, 0.0});
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_NE(remarks[0].find("scans jitter by 16 ms"), std::string::npos) << remarks[0];
  const StampTimes even = entry_of(StampReport{0.0, 0.016, 0.0});
  EXPECT_EQ(even.scans, 0.016);
  EXPECT_EQ(even.ticks + even.time_increment, 0.0);
  EXPECT_FALSE(even.clocks) << "of one recording";
  EXPECT_EQ(entry_of(StampReport{.clocks = 0.02}).clocks, 0.02);
}

}  // namespace
}  // namespace odomcalib::calib::ingest::stamps_test
