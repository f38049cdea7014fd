// Counters that start again at a number of their own, and counts that only look like it.
#include "proto/recording/counter_modulus.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "proto/recording/tick_counts.hpp"

namespace odomcalib::counter_modulus_test {
namespace {

const RobotDescription kRobot{0.15, 0.15, 0.4, 4096.0, std::nullopt, "", ""};

/// Ahead, slower on one side, and back again: counts that have never wrapped.
std::vector<TickSample> drive(double counts_per_sample) {
  std::vector<TickSample> ticks;
  double left = 0.0, right = 0.0;
  for (int k = 0; k < 3000; ++k) {
    const double speed = counts_per_sample * std::sin(0.0021 * k);
    left += speed;
    right += 0.7 * speed + 0.3 * counts_per_sample * std::sin(0.013 * k);
    ticks.push_back({0.02 * k, std::llround(left), std::llround(right), 0});
  }
  return ticks;
}

std::vector<TickSample> wrapped(std::vector<TickSample> ticks, std::int64_t modulus,
                                std::int64_t lowest = 0) {
  const auto wrap = [&](std::int64_t count) {
    return ((count - lowest) % modulus + modulus) % modulus + lowest;
  };
  for (TickSample& tick : ticks) tick.left = wrap(tick.left), tick.right = wrap(tick.right);
  return ticks;
}

TEST(CounterModulus, is_found_where_counters_wrap_at_a_usual_number) {
  for (const std::int64_t modulus : {256, 360, 1000, 4096, 9000})
    for (const double share : {0.007, 0.02, 0.1}) {
      const double speed = share * static_cast<double>(modulus);
      EXPECT_EQ(counter_modulus(wrapped(drive(speed), modulus)), modulus) << modulus << " at " << speed;
    }
  EXPECT_EQ(counter_modulus(wrapped(drive(12.0), 1000, -500)), 1000) << "signed";
}

TEST(CounterModulus, is_found_to_the_count_where_no_encoder_has_it) {
  EXPECT_EQ(counter_modulus(wrapped(drive(55.0), 7777)), 7777);
}

TEST(CounterModulus, is_none_of_counts_that_do_not_wrap) {
  EXPECT_FALSE(counter_modulus(drive(12.0)));
  EXPECT_FALSE(counter_modulus({}));
  std::vector<TickSample> reset = drive(12.0);
  for (std::size_t k = 900; k < reset.size(); ++k) reset[k].left -= reset[900].left;
  EXPECT_FALSE(counter_modulus(reset)) << "a single reset";
  std::vector<TickSample> resets = drive(12.0);
  for (std::size_t k = 0; k < resets.size(); ++k) resets[k].left -= drive(12.0)[k - k % 700].left;
  EXPECT_FALSE(counter_modulus(resets)) << "resets from different counts";
}

TEST(CounterModulus, gives_the_motion_of_the_counter_that_never_wrapped) {
  const std::vector<TickSample> plain = drive(12.0);
  std::vector<TickSample> ticks = wrapped(plain, 1000);
  const ContinuedCounts found = continue_counts(ticks, kRobot);
  EXPECT_EQ(found.modulus, 1000);
  EXPECT_EQ(found.breaks, 0U);
  for (std::size_t k = 1; k < ticks.size(); ++k) {
    ASSERT_EQ(ticks[k].left - ticks[k - 1].left, plain[k].left - plain[k - 1].left) << k;
    ASSERT_EQ(ticks[k].right - ticks[k - 1].right, plain[k].right - plain[k - 1].right) << k;
  }
}

TEST(CountSpeeds, are_limited_by_those_of_the_recording_whatever_their_unit) {
  for (const double factor : {1.0, 60.0}) {
    std::vector<TickSample> ticks = drive(12.0);
    for (TickSample& tick : ticks) {
      tick.left = std::llround(factor * static_cast<double>(tick.left));
      tick.right = std::llround(factor * static_cast<double>(tick.right));
    }
    EXPECT_EQ(continue_counts(ticks, kRobot).breaks, 0U) << factor;
    ticks = drive(12.0);
    for (std::size_t k = 0; k < ticks.size(); ++k) {
      ticks[k].left = std::llround(factor * static_cast<double>(ticks[k].left + (k >= 1500 ? 300'000 : 0)));
      ticks[k].right = std::llround(factor * static_cast<double>(ticks[k].right));
    }
    EXPECT_EQ(continue_counts(ticks, kRobot).jumps, 1U) << "a jump is none in any unit, " << factor;
  }
}

}  // namespace
}  // namespace odomcalib::counter_modulus_test
