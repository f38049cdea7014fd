// Effects put into a recording by hand: counts, stamps and beams of a robot without an effect are changed
// afterwards, with neither the simulator's laws nor the catalogue's in between.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "calib/solve.hpp"
#include "tests/integration/accuracy_runs.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib::edited_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr unsigned kSeed = 815;

const sim::SimulatedRun& plain_run() {
  static const sim::SimulatedRun run = [] {
    sim::SimulationConfig config = sim::standard_config(9);
    config.duration = 290.0;
    return sim::simulate_recording(config, sim::follow(config.nominal, sim::guided_pattern(0.8)));
  }();
  return run;
}

/// Motion of both wheels between two tick samples.
struct Interval {
  double t = 0.0, dt = 0.0;                  ///< s, of the end; duration
  double left = 0.0, right = 0.0;            ///< counts
  double left_rate = 0.0, right_rate = 0.0;  ///< rad/s, mean over 0.14 s
};

/// Counts in the interval as the changed robot would have counted them.
using Counting = std::function<std::pair<double, double>(const Interval&)>;

double rate_about(const std::vector<TickSample>& ticks, std::size_t k, std::int64_t TickSample::*side,
                  double counts) {
  constexpr std::size_t kReach = 3;
  const TickSample& a = ticks[k > kReach ? k - 1 - kReach : 0];
  const TickSample& b = ticks[std::min(k + kReach, ticks.size() - 1)];
  return 2.0 * kPi / counts * static_cast<double>(b.*side - a.*side) / (b.t - a.t);
}

void recount(Recording& recording, const Counting& counting) {
  const std::vector<TickSample> before = recording.ticks;
  const double counts = recording.robot.ticks_per_rev;
  double left = 0.0, right = 0.0;
  for (std::size_t k = 1; k < before.size(); ++k) {
    const TickSample &a = before[k - 1], &b = before[k];
    const Interval interval{b.t,
                            b.t - a.t,
                            static_cast<double>(b.left - a.left),
                            static_cast<double>(b.right - a.right),
                            rate_about(before, k, &TickSample::left, counts),
                            rate_about(before, k, &TickSample::right, counts)};
    const auto [more_left, more_right] = counting(interval);
    left += more_left;
    right += more_right;
    recording.ticks[k].left = before[0].left + std::llround(left);
    recording.ticks[k].right = before[0].right + std::llround(right);
  }
}

struct Edit {
  std::string name;
  std::function<void(Recording&)> make;
  std::string told;         ///< a name, one of its aliases, or a variable; empty: nothing may be told
  std::string remark = "";  ///< in the only reason to warn
};

std::ostream& operator<<(std::ostream& out, const Edit& edit) { return out << edit.name; }

Edit of_left_wheel(const std::string& name, std::function<double(const Interval&)> factor,
                   const std::string& told) {
  return {name,
          [factor = std::move(factor)](Recording& r) {
            recount(r, [&](const Interval& i) { return std::pair(i.left * factor(i), i.right); });
          },
          told};
}

/// Loses a third of its counts over the first three centimetres after each reversal, as a friction wheel
/// does.
void give_play(Recording& recording) {
  double left_to_lose = 0.0, direction = 0.0;
  recount(recording, [&, counts = recording.robot.ticks_per_rev](const Interval& i) {
    const double now = static_cast<double>(i.left > 0.0) - static_cast<double>(i.left < 0.0);
    if (now != 0.0 && now != direction) {
      direction = now;
      left_to_lose = 0.06 * counts;
    }
    const double taken = std::min(std::abs(i.left), left_to_lose);
    left_to_lose -= taken;
    return std::pair(i.left - 0.3 * taken * now, i.right);
  });
}

/// Five errors to a turn: an encoder's gear that is out of round.
void bend_gear(Recording& recording) {
  constexpr double kTeeth = 5.0, kShare = 0.02;
  double angle = 0.0;
  recount(recording, [&, counts = recording.robot.ticks_per_rev](const Interval& i) {
    const double before = std::sin(kTeeth * angle);
    angle += 2.0 * kPi * i.left / counts;
    const double error = kShare / kTeeth * (std::sin(kTeeth * angle) - before) * counts / (2.0 * kPi);
    return std::pair(i.left + error, i.right);
  });
}

/// The left counts are those of 25 ms ago.
void delay_left(Recording& recording) {
  constexpr double kAge = 0.025;  // s
  const std::vector<TickSample> before = recording.ticks;
  std::size_t k = 0;
  for (TickSample& tick : recording.ticks) {
    while (k + 2 < before.size() && before[k + 1].t <= tick.t - kAge) ++k;
    const double share =
        std::clamp((tick.t - kAge - before[k].t) / (before[k + 1].t - before[k].t), 0.0, 1.0);
    tick.left =
        before[k].left + std::llround(share * static_cast<double>(before[k + 1].left - before[k].left));
  }
}

/// A gust turns the base to and fro as it goes, whichever way it goes.
void blow(Recording& recording) {
  recount(recording, [](const Interval& i) {
    const double more = 0.006 * std::cos(2.0 * kPi * i.t / 55.0) * 0.5 * std::abs(i.left + i.right);
    return std::pair(i.left - more, i.right + more);
  });
}

/// The head slips on its mount half-way.
void turn_head(Recording& recording) {
  for (Scan& scan : recording.scans)
    if (scan.t > 145.0) scan.angle_min += 0.01;
}

void lose_samples(Recording& recording) {
  std::size_t k = 0;
  std::erase_if(recording.ticks, [&](const TickSample&) { return ++k % 7 == 0; });
  std::erase_if(recording.scans, [&](const Scan&) { return ++k % 5 == 0; });
}

/// A driver that sends both on when it gets round to it.
template <typename Sample>
void jitter(std::vector<Sample>& samples, double deviation) {
  std::mt19937 engine(kSeed);
  std::normal_distribution<double> late(0.0, deviation);
  for (Sample& sample : samples) sample.t += late(engine);
  std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.t < b.t; });
}

/// Four samples arrive together, when the last of them was taken.
void burst(Recording& recording) {
  constexpr std::size_t kAtOnce = 4;
  auto& ticks = recording.ticks;
  for (std::size_t k = 0; k + kAtOnce <= ticks.size(); k += kAtOnce)
    for (std::size_t j = 0; j < kAtOnce; ++j)
      ticks[k + j].t = ticks[k + kAtOnce - 1].t + 1e-4 * static_cast<double>(j);
}

void forget_beam_times(Recording& recording) {
  for (Scan& scan : recording.scans) scan.time_increment.reset();
}

class Edited : public ::testing::TestWithParam<Edit> {};

TEST_P(Edited, is_told_and_keeps_the_wheels_right) {
  Recording recording = plain_run().recording;
  GetParam().make(recording);
  const Calibration result = calib::solve({&recording, 1}, {});
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  ASSERT_FALSE(result.parameters.empty()) << result.reasons[0];
  if (GetParam().told.empty()) {
    EXPECT_EQ(result.reasons.size(), GetParam().remark.empty() ? 0U : 1U);
    for (const std::string& reason : result.reasons)
      EXPECT_NE(reason.find(GetParam().remark), std::string::npos) << reason;
    EXPECT_TRUE(result.effects.empty()) << test_support::told(result);
    EXPECT_FALSE(result.unexplained) << test_support::told(result);
  } else {
    EXPECT_TRUE(test_support::is_told(result, GetParam().told)) << test_support::told(result);
  }
  for (const double sigma : test_support::length_errors_in_sigmas(result, plain_run().truth))
    EXPECT_LT(std::abs(sigma), 4.0) << test_support::told(result);
}

/// Every fifth of fifty turns a second is sent.
TEST(Sweeps, are_not_assumed_of_a_head_that_turns_faster) {
  sim::SimulationConfig config = sim::standard_config(9);
  config.duration = 90.0;
  config.lidar.turns_per_second = 50.0;
  config.lidar.beams_per_turn = 180;
  Recording recording =
      sim::simulate_recording(config, sim::follow(config.nominal, sim::guided_pattern(0.8))).recording;
  forget_beam_times(recording);
  std::size_t k = 0;
  std::erase_if(recording.scans, [&](const Scan&) { return k++ % 5 != 0; });
  const Calibration result = calib::solve({&recording, 1}, {});
  EXPECT_NE(result.verdict, Verdict::refused) << result.reasons[0];
  EXPECT_FALSE(result.stamps);
}

/// As of a head that turns the other way under a driver that sorts the beams and counts their times along
/// the list.
void list_backwards(Recording& recording) {
  for (Scan& scan : recording.scans) {
    scan.angle_min = scan.angle(scan.ranges.size() - 1);
    scan.angle_increment = -scan.angle_increment;
    std::reverse(scan.ranges.begin(), scan.ranges.end());
  }
}

void list_backwards_without_times(Recording& recording) {
  list_backwards(recording);
  forget_beam_times(recording);
}

void halve_beam_times(Recording& recording) {
  for (Scan& scan : recording.scans) *scan.time_increment *= 0.5;
}

class OtherSweeps : public ::testing::TestWithParam<Edit> {};

TEST_P(OtherSweeps, are_put_right_and_make_no_other_effect) {
  Recording recording = plain_run().recording;
  GetParam().make(recording);
  const Calibration result = calib::solve({&recording, 1}, {});
  ASSERT_EQ(result.effects.size(), 1U) << test_support::told(result);
  EXPECT_EQ(result.effects.front().name, GetParam().told);
  EXPECT_FALSE(result.unexplained) << test_support::told(result);
  ASSERT_EQ(result.reasons.size(), 1U);
  EXPECT_NE(result.reasons.front().find(GetParam().remark), std::string::npos) << result.reasons.front();
  const Calibration plain = calib::solve({&plain_run().recording, 1}, {});
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_LT(result.parameters[k].second.std, 1.2 * plain.parameters[k].second.std)
        << result.parameters[k].first;
  for (const double sigma : test_support::length_errors_in_sigmas(result, plain_run().truth))
    EXPECT_LT(std::abs(sigma), 4.0) << test_support::told(result);
}

INSTANTIATE_TEST_SUITE_P(
    ByHand, OtherSweeps,
    ::testing::Values(Edit{"listed_backwards", list_backwards, "scan_skew", "against the order"},
                      Edit{"listed_backwards_without_times", list_backwards_without_times, "scan_skew",
                           "against the order"},
                      Edit{"half_the_time", halve_beam_times, "scan_skew", "other times of their beams"}),
    [](const auto& edited) { return edited.param.name; });

double slower_than(double rate, double limit) { return std::abs(rate) < limit ? 1.0 : 0.0; }

INSTANTIATE_TEST_SUITE_P(
    ByHand, Edited,
    ::testing::Values(
        Edit{"nothing", [](Recording&) {}, ""}, Edit{"lost_samples", lose_samples, ""},
        of_left_wheel(
            "slow_wave", [](const Interval& i) { return 1.0 + 0.02 * std::sin(2.0 * kPi * i.t / 40.0); },
            "time"),
        of_left_wheel(
            "slow_loss", [](const Interval& i) { return 1.0 - 0.07 * slower_than(i.left_rate, 1.1); },
            "left_speed"),
        of_left_wheel(
            "eight_per_cent_backward", [](const Interval& i) { return i.left < 0.0 ? 1.08 : 1.0; },
            "direction_dependent_diameter"),
        of_left_wheel(
            "slips_for_a_while", [](const Interval& i) { return i.t > 145.0 && i.t < 162.0 ? 1.05 : 1.0; },
            "time"),
        Edit{"play", give_play, "backlash"}, Edit{"gear", bend_gear, "left_phase"},
        Edit{"late_left_counts", delay_left, "encoder_lag"}, Edit{"turned_head", turn_head, "time"},
        Edit{"wind", blow, "time"},
        Edit{"a_little_late",
             [](Recording& r) {
               for (Scan& scan : r.scans) scan.t += 1.5e-3;
             },
             ""},
        // As drivers of lidars that turn all the way round have done: the turn over n - 1 steps instead of n.
        Edit{"a_turn_of_one_step_less",
             [](Recording& r) {
               for (Scan& scan : r.scans)
                 scan.angle_increment *=
                     static_cast<double>(scan.ranges.size()) / static_cast<double>(scan.ranges.size() - 1);
             },
             "angle_scale"},
        Edit{"tick_stamps_jitter", [](Recording& r) { jitter(r.ticks, 3e-3); }, ""},
        Edit{"scan_stamps_jitter", [](Recording& r) { jitter(r.scans, 4e-3); }, ""},
        Edit{"ticks_in_bursts", burst, "time_offset"},
        Edit{"beams_without_times", forget_beam_times, "scan_skew", "time_increment"}),
    [](const auto& edited) { return edited.param.name; });

}  // namespace
}  // namespace odomcalib::edited_test
