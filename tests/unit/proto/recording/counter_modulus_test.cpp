// Counters that start again at a number of their own, and counts that only look like it.
#include "proto/recording/counter_modulus.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

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

/// Number at which both counters wrap, where it is the same.
std::optional<std::int64_t> modulus_of_both(const std::vector<TickSample>& ticks) {
  const auto moduli = counter_moduli(ticks);
  EXPECT_EQ(moduli[0].modulus, moduli[1].modulus);
  return moduli[0].modulus != 0 ? std::optional(moduli[0].modulus) : std::nullopt;
}

bool is_suspected(const std::vector<TickSample>& ticks) {
  const auto moduli = counter_moduli(ticks);
  return moduli[0].suspected != 0 || moduli[1].suspected != 0;
}

/// Every so many samples, as a bus has them that is read seldom.
std::vector<TickSample> thinned(const std::vector<TickSample>& ticks, std::size_t every) {
  std::vector<TickSample> kept;
  for (std::size_t k = 0; k < ticks.size(); k += every) kept.push_back(ticks[k]);
  return kept;
}

/// Straight lines and turns at one speed, with a stop after each: as a guided drive has them.
/// @param part_length samples of a line or turn with its stop, a tenth of them to reach the speed
std::vector<TickSample> guided_drive(double fastest, int part_length = 300) {
  std::vector<TickSample> ticks;
  double left = 0.0, right = 0.0, speed = 0.0;
  for (int k = 0; k < 6000; ++k) {
    const int part = k / part_length;
    const double wanted = k % part_length < part_length * 8 / 10 ? fastest : 0.0;
    speed += std::clamp(wanted - speed, -10.0 * fastest / part_length, 10.0 * fastest / part_length);
    left += part % 4 == 1 || part % 4 == 2 ? -speed : speed;
    right += part % 4 >= 2 ? -0.93 * speed : 0.93 * speed;
    ticks.push_back({0.02 * k, std::llround(left), std::llround(right), 0});
  }
  return ticks;
}

void expect_motion_of(const std::vector<TickSample>& plain, std::vector<TickSample> ticks,
                      const std::string& what, const RobotDescription& robot = kRobot) {
  const ContinuedCounts found = continue_counts(ticks, robot);
  EXPECT_EQ(found.breaks, 0U) << what;
  for (std::size_t k = 1; k < ticks.size(); ++k) {
    ASSERT_EQ(ticks[k].left - ticks[k - 1].left, plain[k].left - plain[k - 1].left) << what << " at " << k;
    ASSERT_EQ(ticks[k].right - ticks[k - 1].right, plain[k].right - plain[k - 1].right)
        << what << " at " << k;
  }
}

TEST(CounterModulus, is_found_where_counters_wrap_at_a_usual_number) {
  for (const std::int64_t modulus : {256, 360, 1000, 4096, 9000})
    for (const double share : {0.007, 0.02, 0.1}) {
      const double speed = share * static_cast<double>(modulus);
      EXPECT_EQ(modulus_of_both(wrapped(drive(speed), modulus)), modulus) << modulus << " at " << speed;
    }
  EXPECT_EQ(modulus_of_both(wrapped(drive(12.0), 1000, -500)), 1000) << "signed";
}

TEST(CounterModulus, is_found_to_the_count_where_no_encoder_has_it) {
  EXPECT_EQ(modulus_of_both(wrapped(drive(55.0), 7777)), 7777);
}

TEST(CounterModulus, is_none_of_counts_that_do_not_wrap) {
  EXPECT_FALSE(modulus_of_both(drive(12.0)));
  EXPECT_FALSE(modulus_of_both({}));
  std::vector<TickSample> reset = drive(12.0);
  for (std::size_t k = 900; k < reset.size(); ++k) reset[k].left -= reset[900].left;
  EXPECT_FALSE(modulus_of_both(reset)) << "a single reset";
  std::vector<TickSample> resets = drive(12.0);
  for (std::size_t k = 0; k < resets.size(); ++k) resets[k].left -= drive(12.0)[k - k % 700].left;
  EXPECT_FALSE(modulus_of_both(resets)) << "resets from different counts";
}

TEST(CounterModulus, gives_the_motion_of_the_counter_that_never_wrapped) {
  const std::vector<TickSample> plain = drive(12.0);
  std::vector<TickSample> ticks = wrapped(plain, 1000);
  EXPECT_EQ(continue_counts(ticks, kRobot).moduli[0].modulus, 1000);
  expect_motion_of(plain, wrapped(plain, 1000), "1000");
}

TEST(CounterModulus, is_found_where_wheels_go_far_from_sample_to_sample) {
  for (const std::int64_t modulus : {256, 1000, 4096, 9000})
    for (const double share : {0.05, 0.09, 0.2})  // of the number, in a fifth of what is read here
      for (const std::size_t every : {5U, 10U}) {
        const std::vector<TickSample> plain = guided_drive(share * static_cast<double>(modulus));
        const std::vector<TickSample> seldom = thinned(plain, every);
        const std::string what =
            std::to_string(modulus) + " at " + std::to_string(share) + " every " + std::to_string(every);
        const auto moduli = counter_moduli(wrapped(seldom, modulus));
        // Steps of up to twice the number: known, and continued, or said.
        if (moduli[0].modulus != 0 && moduli[1].modulus != 0)
          expect_motion_of(seldom, wrapped(seldom, modulus), what);
        else
          EXPECT_TRUE(is_suspected(wrapped(seldom, modulus))) << what;
        if (share * static_cast<double>(every) < 0.5) {
          EXPECT_EQ(moduli[0].modulus, modulus) << what;
          EXPECT_FALSE(moduli[0].is_fast) << what;
        }
      }
}

TEST(CounterModulus, is_told_by_the_span_of_the_counts_where_the_jumps_miss_it) {
  std::size_t missed = 0;
  for (const double share : {0.05, 0.07, 0.08, 0.09})
    for (const int part : {150, 200, 250, 300}) {
      const std::vector<TickSample> plain = thinned(guided_drive(share * 4096.0, part), 5);
      const auto moduli = counter_moduli(wrapped(plain, 4096));
      EXPECT_EQ(moduli[0].modulus, 4096) << share << " in parts of " << part;
      EXPECT_EQ(moduli[1].modulus, 4096) << share << " in parts of " << part;
      missed += moduli[0].suspected != 0;
    }
  EXPECT_EQ(missed, 0U);
}

TEST(CounterModulus, of_steps_longer_than_half_of_it_is_passed_as_the_step_before_says) {
  for (const std::int64_t modulus : {256, 4096}) {
    RobotDescription fine = kRobot;
    fine.ticks_per_rev = 64.0 * static_cast<double>(modulus);
    const std::vector<TickSample> plain = guided_drive(1.4 * static_cast<double>(modulus));
    const auto moduli = counter_moduli(wrapped(plain, modulus));
    EXPECT_EQ(moduli[0].modulus, modulus);
    EXPECT_TRUE(moduli[0].is_fast);
    expect_motion_of(plain, wrapped(plain, modulus), std::to_string(modulus), fine);
  }
}

TEST(CounterModulus, of_a_fast_counter_says_nothing_across_lost_samples_until_the_wheels_rest) {
  std::vector<TickSample> plain = guided_drive(300.0);
  plain.erase(plain.begin() + 400, plain.begin() + 404);
  std::vector<TickSample> ticks = wrapped(plain, 256);
  const ContinuedCounts found = continue_counts(ticks, kRobot);
  EXPECT_GT(found.jumps, 100U);
  EXPECT_LT(found.jumps, 300U);
  EXPECT_EQ(ticks.back().left - ticks[1000].left, plain.back().left - plain[1000].left);
}

TEST(CounterModulus, is_one_of_each_wheel) {
  const std::vector<TickSample> plain = drive(40.0);
  std::vector<TickSample> ticks = wrapped(plain, 9000);
  const std::vector<TickSample> other = wrapped(plain, 4096);
  for (std::size_t k = 0; k < ticks.size(); ++k) ticks[k].right = other[k].right;
  EXPECT_EQ(counter_moduli(ticks)[0].modulus, 9000);
  EXPECT_EQ(counter_moduli(ticks)[1].modulus, 4096);
  expect_motion_of(plain, ticks, "two numbers");
  for (std::size_t k = 0; k < ticks.size(); ++k) ticks[k].left = plain[k].left;
  EXPECT_EQ(counter_moduli(ticks)[0].modulus, 0);
  EXPECT_EQ(counter_moduli(ticks)[1].modulus, 4096);
  expect_motion_of(plain, ticks, "one wheel");
}

TEST(CounterModulus, that_is_not_told_is_suspected_and_its_jumps_are_left_out) {
  const std::vector<TickSample> plain = thinned(guided_drive(75.0), 5);
  std::vector<TickSample> ticks = wrapped(plain, 1234);
  const auto moduli = counter_moduli(ticks);
  EXPECT_EQ(moduli[0].modulus, 0);
  EXPECT_NEAR(static_cast<double>(moduli[0].suspected), 1234.0, 30.0);
  EXPECT_GT(continue_counts(ticks, kRobot).jumps, 30U);
}

TEST(CounterModulus, is_not_suspected_in_counts_that_do_not_wrap) {
  for (const double speed : {2.0, 12.0, 300.0})
    for (const std::size_t every : {1U, 5U, 25U, 100U}) {
      EXPECT_FALSE(is_suspected(thinned(drive(speed), every))) << speed << " every " << every;
      EXPECT_FALSE(is_suspected(thinned(guided_drive(speed), every))) << speed << " every " << every;
    }
  std::vector<TickSample> in_turn = drive(12.0);
  for (std::size_t k = 0; k < in_turn.size(); k += 2) in_turn[k].left = in_turn[k].right = 0;
  EXPECT_FALSE(is_suspected(in_turn)) << "a second program writes zeros";
  std::vector<TickSample> misread = drive(12.0);
  for (std::size_t k = 50; k < misread.size(); k += 200) misread[k].left += 1'000'000;
  EXPECT_FALSE(is_suspected(misread)) << "wild counts";
  std::vector<TickSample> rocking;
  rocking.reserve(600);
  for (int k = 0; k < 600; ++k) rocking.push_back({0.1 * k, k % 4 < 2 ? 0 : 230, k % 6 < 3 ? 0 : 230, 0});
  EXPECT_FALSE(is_suspected(rocking)) << "to and fro by a step";
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
