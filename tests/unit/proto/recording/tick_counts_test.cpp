#include "proto/recording/tick_counts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/unit/proto/support.hpp"

namespace odomcalib::tick_counts_test {
namespace {

constexpr double kInterval = 0.05;  // s

/// A drive with changing, plausible speeds: up to 1 m/s, that is 207 counts a sample.
std::vector<TickSample> drive(std::mt19937& random, std::size_t samples, std::int64_t left,
                              std::int64_t right) {
  std::vector<TickSample> out;
  std::int64_t left_speed = 0;
  std::int64_t right_speed = 0;
  std::uniform_int_distribution<std::int64_t> change(-20, 20);
  for (std::size_t i = 0; i < samples; ++i) {
    out.push_back({static_cast<double>(i) * kInterval, left, right, 0});
    left_speed = std::clamp<std::int64_t>(left_speed + change(random), -207, 207);
    right_speed = std::clamp<std::int64_t>(right_speed + change(random), -207, 207);
    left += left_speed;
    right += right_speed;
  }
  return out;
}

template <typename Counter>
std::vector<TickSample> wrapped(std::vector<TickSample> ticks) {
  for (auto& sample : ticks) {
    sample.left = static_cast<Counter>(sample.left);
    sample.right = static_cast<Counter>(sample.right);
  }
  return ticks;
}

void expect_same_motion(const std::vector<TickSample>& actual, const std::vector<TickSample>& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i) {
    ASSERT_EQ(actual[i].segment, 0) << "sample " << i;
    ASSERT_EQ(actual[i].left - actual[0].left, expected[i].left - expected[0].left) << "sample " << i;
    ASSERT_EQ(actual[i].right - actual[0].right, expected[i].right - expected[0].right) << "sample " << i;
  }
}

template <typename Counter>
class Wrapping : public testing::Test {};
using Counters = testing::Types<std::int16_t, std::uint16_t, std::int32_t, std::uint32_t, std::int64_t>;
TYPED_TEST_SUITE(Wrapping, Counters);

TYPED_TEST(Wrapping, counters_give_the_motion_of_counters_that_never_wrap) {
  const auto seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (int round = 0; round < 30; ++round) {
    // Near both ends of the narrow counters, so that wraps in both directions happen.
    const auto start = static_cast<std::int64_t>(std::numeric_limits<std::int32_t>::max()) - 100 +
                       std::int64_t{1000} * round;
    const auto truth = drive(random, 1500, start, -start);
    auto ticks = wrapped<TypeParam>(truth);
    EXPECT_EQ(continue_counts(ticks, test::example_robot()).breaks, 0U);
    expect_same_motion(ticks, truth);
  }
}

TEST(TickCounts, start_a_new_segment_when_they_are_reset_and_keep_the_motion_of_both_parts) {
  const auto seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  for (const std::int64_t start : {5000, -40000, 1000000}) {
    auto ticks = drive(random, 100, start, start + 3000);
    const auto before = ticks;
    for (std::size_t i = 50; i < ticks.size(); ++i) {
      ticks[i].left -= before[50].left;
      ticks[i].right -= before[50].right;
    }
    EXPECT_EQ(continue_counts(ticks, test::example_robot()).breaks, 1U) << start;
    EXPECT_EQ(ticks[49].segment, 0);
    EXPECT_EQ(ticks[50].segment, 1);
    EXPECT_EQ(ticks[50].left, 0);
    EXPECT_EQ(ticks[99].left - ticks[50].left, before[99].left - before[50].left);
  }
}

/// A metre out and back, at whose end the wheels rock by one count of the encoder about where they began.
TEST(TickCounts, that_rock_about_zero_were_not_reset_however_fine_they_are) {
  for (const std::int64_t count : {1, 64, 4096}) {
    std::vector<TickSample> ticks;
    for (const std::int64_t at : {0, 0, 0, 2, 5, 8, 5, 2, 0, 0, 1, 1, 0, 0, 0, -1, 0, 0})
      ticks.push_back({0.02 * static_cast<double>(ticks.size()), at * count, at * count, 0});
    auto robot = test::example_robot();
    robot.ticks_per_rev = 16384.0 * static_cast<double>(count);
    EXPECT_EQ(continue_counts(ticks, robot).breaks, 0U) << count;
  }
}

TEST(TickCounts, start_a_new_segment_at_a_jump_that_no_wheel_can_make) {
  std::mt19937 random(7);
  for (const std::int64_t jump : {3000, -3000, 70000, 1 << 20}) {
    auto ticks = drive(random, 100, 0, 0);
    for (std::size_t i = 60; i < ticks.size(); ++i) ticks[i].right += jump;
    const ContinuedCounts found = continue_counts(ticks, test::example_robot());
    EXPECT_EQ(found.breaks, 1U) << jump;
    EXPECT_EQ(found.jumps, 1U) << "it is told";
    EXPECT_EQ(ticks[60].segment, 1);
  }
}

TEST(TickCounts, of_a_segment_that_the_controller_began_are_no_jump) {
  std::mt19937 random(7);
  auto ticks = drive(random, 100, 0, 0);
  for (std::size_t i = 60; i < ticks.size(); ++i) {
    ticks[i].right += 70000;
    ticks[i].segment = 1;
  }
  const ContinuedCounts found = continue_counts(ticks, test::example_robot());
  EXPECT_EQ(found.breaks, 1U);
  EXPECT_EQ(found.jumps, 0U);
}

TEST(TickCounts, start_a_new_segment_at_a_single_step_out_of_line) {
  std::mt19937 random(7);
  auto ticks = drive(random, 100, 0, 0);
  for (std::size_t i = 60; i < ticks.size(); ++i) ticks[i].left += 500;  // 2.4 m/s more in one sample
  EXPECT_EQ(continue_counts(ticks, test::example_robot()).breaks, 1U);
}

TEST(TickCounts, are_not_broken_by_jittering_stamps_or_lost_samples) {
  const auto seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> jitter(-0.024, 0.024);
  auto truth = drive(random, 2000, 0, 0);
  std::vector<TickSample> ticks;
  for (auto sample : truth) {
    sample.t += jitter(random);
    if (random() % 10 != 0) ticks.push_back(sample);
  }
  EXPECT_EQ(continue_counts(ticks, test::example_robot()).breaks, 0U);
}

TEST(TickCounts, are_not_broken_by_a_bus_that_hands_over_several_at_a_time) {
  std::mt19937 random(5);
  const auto ticks = drive(random, 400, 0, 0);
  for (const std::size_t batch : {2U, 3U, 5U}) {
    auto handed_over = ticks;
    for (std::size_t i = 0; i < ticks.size(); ++i)
      handed_over[i].t =
          ticks[std::min(i - i % batch + batch, ticks.size()) - 1].t + 1e-4 * static_cast<double>(i % batch);
    EXPECT_EQ(continue_counts(handed_over, test::example_robot()).breaks, 0U) << batch << " at a time";
    expect_same_motion(handed_over, ticks);
  }
}

TEST(TickCounts, a_single_sample_that_was_read_wrong_moves_nobody) {
  std::mt19937 random(11);
  const auto drive_read_right = drive(random, 400, 1000, -500);
  for (const std::int64_t wrong : {200, 300, -500, 128 << 8, 1 << 16, 1 << 24}) {
    auto ticks = drive_read_right;
    for (std::size_t i = 20; i < ticks.size(); i += 37) ticks[i].right += wrong;
    ticks[30].left = ticks[30].right = 0;
    const auto found = continue_counts(ticks, test::example_robot());
    EXPECT_EQ(found.breaks, 0U) << wrong;
    EXPECT_EQ(found.misread, 12U) << wrong << ": eleven, and both counts once";
    for (std::size_t i = 20; i < ticks.size(); i += 37) {
      EXPECT_NEAR(static_cast<double>(ticks[i].right - drive_read_right[i].right), 0.0, 30.0);
      ticks[i] = drive_read_right[i];
    }
    ticks[30] = drive_read_right[30];
    expect_same_motion(ticks, drive_read_right);
  }
}

TEST(TickCounts, are_not_broken_by_a_disc_of_few_slots_that_is_read_often) {
  RobotDescription robot = test::example_robot();
  robot.ticks_per_rev = 20.0;  // 1.2 m/s for one sample whenever a count comes
  robot.left_wheel_diameter = robot.right_wheel_diameter = 0.08;
  std::vector<TickSample> ticks;
  ticks.reserve(3000);
  for (int i = 0; i < 3000; ++i)
    ticks.push_back({0.01 * i, static_cast<std::int64_t>(std::floor(0.21 * i)), -(i / 11), 0});
  const auto drive = ticks;
  EXPECT_EQ(continue_counts(ticks, robot).breaks, 0U);
  expect_same_motion(ticks, drive);
  for (std::size_t i = 1500; i < ticks.size(); ++i) ticks[i].left += 10;
  EXPECT_EQ(continue_counts(ticks, robot).breaks, 1U);
}

TEST(TickCounts, are_not_broken_where_a_controller_is_asked_more_often_than_it_counts) {
  std::mt19937 random(5);
  const auto drive_at_its_pace = drive(random, 400, 0, 0);
  std::vector<TickSample> asked;
  asked.reserve(8 * drive_at_its_pace.size());
  for (const TickSample& sample : drive_at_its_pace)
    for (int k = 0; k < 8; ++k)
      asked.push_back({sample.t + k * kInterval / 8, sample.left, sample.right, sample.segment});
  const auto drive_as_asked = asked;
  EXPECT_EQ(continue_counts(asked, test::example_robot()).breaks, 0U);
  expect_same_motion(asked, drive_as_asked);
}

TEST(TickCounts, never_join_segments_that_the_source_has_told_apart) {
  std::vector<TickSample> ticks{{0, 0, 0, 3}, {0.1, 10, 10, 3}, {0.2, 20, 20, 7}, {0.3, 30, 30, 7}};
  EXPECT_EQ(continue_counts(ticks, test::example_robot()).breaks, 1U);
  EXPECT_EQ(ticks[1].segment, 0);
  EXPECT_EQ(ticks[2].segment, 1);
  EXPECT_EQ(ticks[3].left, 30);
}

TEST(TickCounts, survive_any_numbers) {
  const auto seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937_64 random(seed);
  for (int round = 0; round < 200; ++round) {
    std::vector<TickSample> ticks;
    ticks.reserve(20);
    const int shift = static_cast<int>(random() % 60);
    for (int i = 0; i < 20; ++i)
      ticks.push_back({i * 0.1, static_cast<std::int64_t>(random()) >> 10 >> (shift / 2),
                       static_cast<std::int64_t>(random()) >> 10, 0});
    const auto robot = round % 2 == 0 ? test::example_robot() : RobotDescription{};
    EXPECT_LT(continue_counts(ticks, robot).breaks, ticks.size());
  }
  std::vector<TickSample> none;
  EXPECT_EQ(continue_counts(none, {}).breaks, 0U);
}

}  // namespace
}  // namespace odomcalib::tick_counts_test
