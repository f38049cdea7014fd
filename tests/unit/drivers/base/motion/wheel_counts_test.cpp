// Counts on their way from the wire to tick samples: wraps, wild counts, restarts, pairs.
#include "drivers/base/motion/wheel_counts.hpp"

#include <gtest/gtest.h>

#include "tests/unit/drivers/test_support.hpp"

namespace odomcalib::drivers::wheel_counts_test {
namespace {

using Kind = TickUnwrap::Reading::Kind;

TEST(TickUnwrap, any_motion_is_followed_across_the_wrap) {
  auto random = test::seeded(9);
  TickUnwrap unwrap(100'000.0);
  std::int64_t truth = 0x7FFFFF00;
  double t = 0.0;
  const auto first = unwrap.on_count(static_cast<std::int32_t>(truth), t).total;
  for (int i = 0; i < 10'000; ++i) {
    const int step = static_cast<int>(random() % 4001) - 1900;
    truth += step;
    t += 0.02;
    const auto reading = unwrap.on_count(static_cast<std::int32_t>(static_cast<std::uint32_t>(truth)), t);
    ASSERT_EQ(reading.kind, Kind::motion);
    ASSERT_EQ(reading.total - first, truth - 0x7FFFFF00);
  }
}

// One and a half times the highest speed, and eight counts; between two counts at least 5 ms.
TEST(TickUnwrap, a_count_that_is_farther_than_a_wheel_turns_is_wild) {
  for (const auto& [seconds, farthest] : {std::pair{0.02, 308}, {0.1, 1508}, {0.001, 83}})
    for (const int sign : {-1, 1})
      for (const int more : {0, 1}) {
        TickUnwrap unwrap(10'000.0);
        (void)unwrap.on_count(5'000, 0.0);
        const auto reading = unwrap.on_count(5'000 + sign * (farthest + more), seconds);
        EXPECT_EQ(reading.kind, more == 0 ? Kind::motion : Kind::wild) << seconds << " " << sign * farthest;
      }
}

TEST(TickUnwrap, a_counter_that_begins_anew_is_told_and_the_total_goes_on) {
  TickUnwrap unwrap(10'000.0);
  const auto before = unwrap.on_count(5'000'000, 0.0);
  const auto reset = unwrap.on_count(0, 0.02);
  EXPECT_EQ(reset.kind, Kind::wild);
  EXPECT_EQ(reset.total, before.total);
  const auto anew = unwrap.on_count(250, 0.04);
  EXPECT_EQ(anew.kind, Kind::restarted);
  EXPECT_EQ(anew.total, before.total + 250);
  EXPECT_EQ(unwrap.on_count(400, 0.06).kind, Kind::motion);
}

TEST(TickUnwrap, the_motion_during_a_wild_count_is_kept) {
  TickUnwrap unwrap(10'000.0);
  (void)unwrap.on_count(1000, 0.0);
  EXPECT_EQ(unwrap.on_count(0x40000000, 0.02).kind, Kind::wild);
  const auto after = unwrap.on_count(1080, 0.04);
  EXPECT_EQ(after.kind, Kind::motion);
  EXPECT_EQ(after.total, 1080);
}

TEST(TickUnwrap, several_wild_counts_in_a_row_are_none_of_them_motion) {
  TickUnwrap unwrap(10'000.0);
  (void)unwrap.on_count(1000, 0.0);
  for (const std::int64_t wild : {900'000, -900'000, 40'000'000})
    EXPECT_EQ(unwrap.on_count(wild, 0.01).kind, Kind::wild);
  EXPECT_EQ(unwrap.on_count(1040, 0.02).total, 1040);
}

Profile profile() {
  Profile out;
  out.max_rpm = 60.0;
  out.ticks_per_rev = 10'000.0;
  out.right_sign = -1;
  return out;
}

/// Both wheels 40 counts a reading, the right one mounted mirrored; `change` may spoil a raw count.
template <typename Change>
std::vector<TickSample> drive(WheelCounts& counts, int readings, Change change) {
  std::vector<TickSample> out;
  for (int i = 0; i < readings; ++i) {
    std::array<std::int64_t, 2> raw{std::int64_t{40} * i, std::int64_t{-40} * i};
    change(i, raw);
    const double t = 0.02 * i;
    (void)counts.on_count(Side::left, raw[0], t);
    (void)counts.on_count(Side::right, raw[1], t);
    for (const TickSample& sample : counts.take()) out.push_back(sample);
  }
  return out;
}

TEST(WheelCounts, one_wild_count_of_either_wheel_costs_no_motion_and_at_most_one_sample) {
  for (const std::size_t side : {0U, 1U}) {
    WheelCounts counts(profile());
    const auto samples = drive(counts, 100, [side](int i, auto& raw) {
      if (i == 50) raw[side] = 123'456'789;
    });
    ASSERT_GE(samples.size(), 99U);
    EXPECT_EQ(samples.back().left, 40 * 99);
    EXPECT_EQ(samples.back().right, 40 * 99);
    EXPECT_EQ(samples.back().segment, 0);
    Counters told;
    counts.count_into(told);
    EXPECT_EQ(told["tick_jumps"], 1U);
    for (std::size_t i = 1; i < samples.size(); ++i)
      EXPECT_NEAR(static_cast<double>(samples[i].left - samples[i - 1].left),
                  2000.0 * (samples[i].t - samples[i - 1].t), 1e-6);
  }
}

TEST(WheelCounts, are_told_by_the_name_of_the_wheel) {
  EXPECT_STREQ(to_text(Side::left), "left");
  EXPECT_STREQ(to_text(Side::right), "right");
}

TEST(WheelCounts, a_restart_begins_a_segment) {
  WheelCounts counts(profile());
  const auto samples = drive(counts, 100, [](int i, auto& raw) {
    if (i >= 50) raw = {40 * (i - 50) + 7'000'000, -40 * (i - 50) + 7'000'000};
  });
  ASSERT_EQ(samples.size(), 98U) << "the first of the new counts, and the one that tells it from a wild one";
  EXPECT_EQ(samples[49].segment, 0);
  EXPECT_GT(samples[50].segment, 0);
  for (std::size_t i = 51; i < samples.size(); ++i) {
    EXPECT_EQ(samples[i].left - samples[i - 1].left, 40);
    EXPECT_EQ(samples[i].right - samples[i - 1].right, 40);
    EXPECT_EQ(samples[i].segment, samples[50].segment);
  }
}

TEST(WheelCounts, nothing_is_continued_across_a_device_that_was_lost) {
  WheelCounts counts(profile());
  (void)drive(counts, 10, [](int, auto&) {});
  counts.begin_segment();
  (void)counts.on_count(Side::left, 9'000'000, 0.3);
  (void)counts.on_count(Side::right, 9'000'000, 0.3);
  const auto samples = counts.take();
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(samples[0].segment, 1);
  EXPECT_EQ(samples[0].left, 40 * 9);
}

}  // namespace
}  // namespace odomcalib::drivers::wheel_counts_test
