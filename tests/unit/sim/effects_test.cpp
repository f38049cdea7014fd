// The blind-test effects: each does nothing at size 0, something at its usual sizes, and what its mechanics
// says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "tests/sim/effects/effect.hpp"
#include "tests/sim/world/rooms.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib::sim::effects_test {
namespace {

constexpr double kPi = std::numbers::pi;

SimulatedRun run_with(Disturbances disturbances) {
  SimulationConfig config = standard_config(3);
  config.body.slip_noise = 0.0;
  config.lidar.range_noise = 0.0;
  config.lidar.beams_per_turn = 60;
  config.disturbances = std::move(disturbances);
  return simulate_recording(config, follow(config.nominal, guided_pattern()));
}

SimulatedRun run_with(const EffectKind& kind, double size, std::uint64_t seed) {
  Random random(seed);
  return run_with({kind.make(size, random)});
}

/// How far two runs are apart, each kind of difference in units that an estimator could just see.
double difference(const SimulatedRun& a, const SimulatedRun& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.path.size(); ++i) {
    const Pose &p = a.path[i].pose, &q = b.path[i].pose;
    most = std::max({most, std::hypot(p.x - q.x, p.y - q.y) / 0.005, std::abs(p.yaw - q.yaw) / 0.005});
  }
  for (std::size_t i = 0; i < a.recording.ticks.size(); ++i) {
    const TickSample &p = a.recording.ticks[i], &q = b.recording.ticks[i];
    most = std::max({most, std::abs(p.t - q.t) / 0.002, static_cast<double>(std::abs(p.left - q.left)) / 20.0,
                     static_cast<double>(std::abs(p.right - q.right)) / 20.0});
  }
  for (std::size_t i = 0; i < a.recording.scans.size(); ++i) {
    const Scan &p = a.recording.scans[i], &q = b.recording.scans[i];
    most = std::max(most, std::abs(p.t - q.t) / 0.002);
    double sum = 0.0;
    for (std::size_t k = 0; k < p.ranges.size(); ++k)
      sum += std::min(0.1, std::abs(static_cast<double>(p.ranges[k]) - static_cast<double>(q.ranges[k])));
    most = std::max(most, sum / static_cast<double>(p.ranges.size()) / 0.003);
  }
  return most;
}

class EveryEffect : public testing::TestWithParam<std::string> {};

TEST_P(EveryEffect, does_nothing_at_size_zero_and_shows_at_its_usual_sizes) {
  const EffectKind& kind = *find_effect(GetParam());
  const SimulatedRun plain = run_with(Disturbances{});
  EXPECT_LT(difference(plain, run_with(kind, 0.0, 5)), 1e-3);
  const double small = difference(plain, run_with(kind, kind.smallest, 5));
  const double large = difference(plain, run_with(kind, kind.largest, 5));
  EXPECT_GT(small, 1.0);
  EXPECT_GT(large, 1.2 * small);
}

TEST_P(EveryEffect, is_deterministic) {
  const EffectKind& kind = *find_effect(GetParam());
  EXPECT_EQ(difference(run_with(kind, kind.largest, 8), run_with(kind, kind.largest, 8)), 0.0);
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const EffectKind& kind : effect_kinds()) out.push_back(kind.name);
  return out;
}

std::vector<std::string> names_of_free_laws() {
  std::vector<std::string> out;
  for (const EffectKind& kind : free_laws()) out.push_back(kind.name);
  return out;
}

INSTANTIATE_TEST_SUITE_P(FreeLaws, EveryEffect, testing::ValuesIn(names_of_free_laws()),
                         [](const auto& test) { return test.param; });

INSTANTIATE_TEST_SUITE_P(Effects, EveryEffect, testing::ValuesIn(names()),
                         [](const auto& test) { return test.param; });

TEST(Effects, have_unique_names_and_at_least_a_third_is_in_no_catalogue) {
  std::set<std::string> unique;
  std::size_t outside = 0;
  for (const EffectKind& kind : effect_kinds()) {
    unique.insert(kind.name);
    outside += kind.catalogue_name.empty() ? 1 : 0;
    EXPECT_GT(kind.largest, kind.smallest) << kind.name;
    EXPECT_FALSE(kind.depends_on.empty()) << kind.name;
  }
  EXPECT_EQ(unique.size(), effect_kinds().size());
  EXPECT_GE(3 * outside, effect_kinds().size());
}

/// Feeds one wheel's turning into an effect and returns the travel of both wheels (ideal: 0.1 m a radian).
class Bench {
 public:
  Bench(const std::string& name, double size, std::uint64_t seed) {
    Random random(seed);
    effect_ = find_effect(name)->make(size, random);
  }
  /// @return travel in this stretch, m
  PerSide turn(double left_rate, double right_rate, double seconds, double acceleration = 0.0) {
    PerSide travelled{};
    const long steps = std::lround(seconds / view_.dt);
    for (long i = 0; i < steps; ++i) {
      view_.rate = {left_rate, right_rate};
      view_.acceleration = {acceleration, acceleration};
      view_.turned = {left_rate * view_.dt, right_rate * view_.dt};
      StepMotion motion;
      motion.travel = {0.1 * view_.turned[kLeft], 0.1 * view_.turned[kRight]};
      motion.track_width = 0.4;
      effect_->on_step(view_, motion);
      for (const std::size_t side : {kLeft, kRight}) {
        travelled[side] += motion.travel[side];
        view_.angle[side] += view_.turned[side];
      }
      encoder = view_.angle;
      effect_->on_encoder(view_, encoder);
      view_.t += view_.dt;
      last_ = motion;
    }
    return travelled;
  }
  [[nodiscard]] const StepMotion& last() const { return last_; }
  [[nodiscard]] const PerSide& angle() const { return view_.angle; }
  PerSide encoder{};

 private:
  std::shared_ptr<Disturbance> effect_;
  StepView view_{0.0, 0.001, {}, {}, {}, {}, {}, 0.0, 0.0};
  StepMotion last_;
};

TEST(GearPlay, loses_the_play_once_at_each_reversal_whatever_the_speed) {
  Bench bench("gear_play", 0.03, 1);
  bench.turn(2.0, 2.0, 1.0);  // against the flank
  EXPECT_NEAR(bench.turn(1.0, 1.0, 1.0)[kLeft], 0.1, 1e-9);
  EXPECT_NEAR(bench.turn(-1.0, -4.0, 1.0)[kLeft], -0.1 * (1.0 - 0.03), 1e-9);
  EXPECT_NEAR(bench.turn(-1.0, -1.0, 1.0)[kLeft], -0.1, 1e-9);
  EXPECT_NEAR(bench.turn(0.5, 5.0, 2.0)[kRight], 0.1 * (10.0 - 0.03), 1e-9);
}

TEST(FlatSpot, costs_the_same_in_every_turn_of_one_wheel_and_nothing_on_the_other) {
  Bench bench("flat_spot", 0.4, 1);
  const double one_turn = 2.0 * kPi;
  const PerSide first = bench.turn(one_turn, one_turn, 1.0), second = bench.turn(one_turn, one_turn, 1.0);
  // Over the flat the travel is that of its chord: the integral of cos(h)/cos(a) is cos(h) * 2 atanh(sin
  // h)... in a.
  const double flat = 0.1 * std::cos(0.4) * 2.0 * std::atanh(std::sin(0.4));
  const double expected = 0.1 * (one_turn - 0.8) + flat;
  const double with = std::min(first[kLeft], first[kRight]), without = std::max(first[kLeft], first[kRight]);
  EXPECT_NEAR(with, expected, 1e-5);
  EXPECT_NEAR(without, 0.1 * one_turn, 1e-9);
  EXPECT_NEAR(second[kLeft], first[kLeft], 1e-5);
}

TEST(OffCentreWheel, rolls_a_full_turn_by_the_mean_distance_of_its_rim) {
  Bench bench("off_centre_wheel", 0.02, 1);
  const PerSide turn = bench.turn(2.0 * kPi, 2.0 * kPi, 1.0);
  const double mean = 1.0 - 0.02 * 0.02 / 4.0;  // second order of the square root
  EXPECT_NEAR(std::min(turn[kLeft], turn[kRight]), 0.1 * 2.0 * kPi * mean, 1e-7);
}

TEST(EncoderInterpolation, repeats_each_quarter_turn) {
  Bench bench("encoder_interpolation", 0.02, 1);
  double largest = 0.0;
  std::vector<double> errors;
  for (int i = 0; i < 400; ++i) {
    bench.turn(2.0 * kPi / 0.4, 2.0 * kPi / 0.4, 0.001);
    errors.push_back(bench.encoder[kLeft] + bench.encoder[kRight] - bench.angle()[kLeft] -
                     bench.angle()[kRight]);
    largest = std::max(largest, std::abs(errors.back()));
  }
  EXPECT_NEAR(largest, 0.02 * 1.3, 0.02 * 0.05);
  for (std::size_t i = 100; i < errors.size(); ++i) EXPECT_NEAR(errors[i], errors[i - 100], 1e-9);
}

TEST(MissedCounts, misses_only_above_a_speed_and_on_one_side) {
  Bench bench("missed_counts", 0.02, 1);
  bench.turn(1.0, 1.0, 10.0);
  EXPECT_NEAR(bench.encoder[kLeft], bench.angle()[kLeft], 0.02 * 10.0 * 0.01);
  const double before = bench.encoder[kLeft] + bench.encoder[kRight];
  bench.turn(8.0, 8.0, 10.0);
  EXPECT_NEAR(bench.encoder[kLeft] + bench.encoder[kRight] - before, 160.0 - 80.0 * 0.02, 0.01);
}

TEST(EncoderFilter, lags_by_its_time_constant_at_constant_speed) {
  Bench bench("encoder_filter", 0.05, 1);
  bench.turn(3.0, -2.0, 3.0);
  EXPECT_NEAR(bench.angle()[kLeft] - bench.encoder[kLeft], 3.0 * 0.05, 3.0 * 0.0015);
  EXPECT_NEAR(bench.angle()[kRight] - bench.encoder[kRight], -2.0 * 0.05, 2.0 * 0.0015);
}

TEST(TractionSlip, has_its_size_at_one_metre_per_second_squared_and_the_sign_of_the_acceleration) {
  Bench bench("traction_slip", 0.03, 1);
  EXPECT_NEAR(bench.turn(5.0, 5.0, 1.0, 10.0)[kLeft], 0.5 * (1.0 - 0.03), 0.5 * 0.002);
  EXPECT_NEAR(bench.turn(5.0, 5.0, 1.0, -10.0)[kLeft], 0.5 * (1.0 + 0.03), 0.5 * 0.002);
  EXPECT_NEAR(bench.turn(-5.0, -5.0, 1.0, -10.0)[kLeft], -0.5 * (1.0 - 0.03), 0.5 * 0.002);
  EXPECT_NEAR(bench.turn(5.0, 5.0, 1.0, 0.0)[kLeft], 0.5, 1e-12);
  const double harder = 0.5 - bench.turn(5.0, 5.0, 1.0, 60.0)[kLeft];
  EXPECT_GT(harder, 6.0 * 0.5 * 0.03) << "the tyre curve bends";
}

TEST(TreadLay, changes_over_within_centimetres_after_a_reversal) {
  Bench bench("tread_lay", 0.01, 1);
  EXPECT_NEAR(bench.turn(1.0, 1.0, 1.0)[kLeft], 0.1, 1e-12);
  bench.turn(-1.0, -1.0, 0.5);
  EXPECT_NEAR(bench.turn(-1.0, -1.0, 1.0)[kLeft], -0.1 * 1.01, 1e-12);
}

TEST(CasterSwing, kicks_the_heading_by_half_a_turn_of_the_caster_at_a_reversal_and_then_rests) {
  Bench bench("caster_swing", 0.01, 1);
  const auto yaw_in = [&bench](double rate, int milliseconds) {
    double sum = 0.0;
    for (int i = 0; i < milliseconds; ++i) {
      bench.turn(rate, rate, 0.001);
      sum += bench.last().yaw;
    }
    return sum;
  };
  yaw_in(3.0, 2000);
  EXPECT_NEAR(yaw_in(3.0, 500), 0.0, 1e-4);
  EXPECT_NEAR(std::abs(yaw_in(-3.0, 3000)), 0.01 * kPi, 0.01 * 0.2);
  EXPECT_NEAR(yaw_in(-3.0, 500), 0.0, 2e-4);
}

TEST(LooseWheel, keeps_its_seat_until_it_is_pushed_the_other_way) {
  Bench bench("loose_wheel", 0.01, 1);
  bench.turn(1.0, 1.0, 0.01, -5.0);
  bench.turn(1.0, 1.0, 1.0, 0.0);
  EXPECT_NEAR(bench.last().track_width, 0.4 * 0.99, 1e-12);
  bench.turn(1.0, 1.0, 0.01, 5.0);
  bench.turn(1.0, 1.0, 1.0, -1.0);
  EXPECT_NEAR(bench.last().track_width, 0.4 * 1.01, 1e-12);
}

TEST(SweepQueue, delays_by_its_size_on_average) {
  Random random(2);
  const auto effect = find_effect("sweep_queue")->make(0.05, random);
  double sum = 0.0;
  constexpr int kSweeps = 4000;
  for (int i = 0; i < kSweeps; ++i) {
    ScanStamp stamp{1.0 * i, 0.1, 1.0 * i};
    effect->on_scan(stamp);
    EXPECT_GE(stamp.stamp, stamp.t + 0.95 * 0.05);
    sum += stamp.stamp - stamp.t;
  }
  EXPECT_NEAR(sum / kSweeps, 0.05, 0.0005);
}

}  // namespace
}  // namespace odomcalib::sim::effects_test
