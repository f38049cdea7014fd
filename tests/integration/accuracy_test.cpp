// The estimators against the independent simulator: how far from the truth, and whether the stated deviations
// are honest.
#include <gtest/gtest.h>

#include "calib/solve.hpp"
#include "tests/integration/accuracy_runs.hpp"
#include "tests/sim/effects/effect.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib {
namespace {

/// Pooled over the six parameters: with this many runs the RMS of one parameter alone scatters by a sixth.
/// The bench (bench_accuracy) has the table for fifty runs.
TEST(Accuracy, twenty_robots_near_the_bound_of_their_range_readings_with_honest_deviations) {
  constexpr std::uint64_t kFirstSeed = 1, kRuns = 20;
  testing::AccuracyTable table;
  for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kRuns; ++seed)
    EXPECT_EQ(table.add(testing::four_minutes(seed), "auto"), "") << "seed " << seed;
  table.print();
  EXPECT_EQ(table.runs(), kRuns);
  EXPECT_LT(table.pooled_ratio(), testing::kRatioBar);
  EXPECT_GT(table.pooled_ratio(), 0.7) << "better than the bound allows: the bound is wrong";
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(table.relative_rms(k), 3e-4) << "length " << k;
  // 95 % of 120 truths, give or take what parameters of one run that err together allow.
  EXPECT_GE(table.coverage(), 0.90);
  EXPECT_LE(table.coverage(), 0.99);
}

struct Injected {
  const char* simulated;  ///< the simulator's own law
  double size;
  const char* name;  ///< what the report must call it, list among what it cannot tell from it, or depend on
};

class NamesTheEffect : public ::testing::TestWithParam<Injected> {};

TEST_P(NamesTheEffect, and_keeps_the_wheels_right) {
  sim::SimulationConfig config = sim::standard_config(5);
  const sim::EffectKind* kind = sim::find_effect(GetParam().simulated);
  ASSERT_NE(kind, nullptr);
  sim::Random random(5);
  config.disturbances = {kind->make(GetParam().size, random)};
  config.duration = 290.0;
  const sim::SimulatedRun run =
      sim::simulate_recording(config, sim::follow(config.nominal, sim::guided_pattern()));
  const Calibration result = calib::solve({&run.recording, 1}, {});
  ASSERT_NE(result.verdict, Verdict::refused) << result.reasons[0];
  std::string found;
  bool named = false;
  for (const EffectResult& effect : result.effects) {
    found += effect.name + " ";
    named = named || effect.name == GetParam().name;
    for (const std::string& alias : effect.aliases) named = named || alias == GetParam().name;
  }
  if (result.unexplained)
    for (const std::string& variable : result.unexplained->depends_on)
      named = named || variable == GetParam().name;
  EXPECT_TRUE(named) << "found: " << found << (result.unexplained ? "and a curve" : "");
  EXPECT_LE(result.effects.size(), 1U) << "more than what is there: " << found;
  for (const double sigma : testing::length_errors_in_sigmas(result, run.truth))
    EXPECT_LT(std::abs(sigma), 4.0);
}

INSTANTIATE_TEST_SUITE_P(Simulated, NamesTheEffect,
                         ::testing::Values(Injected{"rim_growth", 0.012, "speed_dependent_radius"},
                                           Injected{"turn_drag", 0.006, "turn_direction_asymmetry"},
                                           Injected{"gear_play", 0.05, "backlash"},
                                           Injected{"cover_glass", 0.03, "range_bias"},
                                           Injected{"cover_glass", 0.012, "range_bias"},
                                           Injected{"slanted_echo", 0.01, "incidence"},
                                           Injected{"leaning_head", 0.07, "lidar_tilt"},
                                           Injected{"head_disc_off_centre", 0.02, "bearing"}),
                         [](const auto& tested) {
                           return std::string(tested.param.name) + "_" + std::to_string(tested.index);
                         });

}  // namespace
}  // namespace odomcalib
