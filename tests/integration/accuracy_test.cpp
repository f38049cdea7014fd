// The estimators against the independent simulator: how far from the truth, and whether the stated deviations
// are honest.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "calib/solve.hpp"
#include "tests/sim/effects/effect.hpp"
#include "tests/sim/world/simulate.hpp"

namespace odomcalib {
namespace {

constexpr std::uint64_t kFirstSeed = 1;
constexpr std::size_t kLengths = 3;

struct Outcome {
  std::array<double, kLengths> relative_error{};
  std::array<double, kLengths> sigmas{};
};

/// Four minutes of the guided pattern in a furnished room: 8 mm range noise, 50 Hz ticks, 10 Hz lidar.
sim::SimulatedRun four_minutes(std::uint64_t seed) {
  sim::SimulationConfig config = sim::standard_config(seed);
  config.duration = 240.0;
  return sim::simulate_recording(config, sim::follow(config.nominal, sim::guided_pattern()));
}

Outcome compare(const Calibration& calibration, const sim::Geometry& truth) {
  const std::array<double, kLengths> values = {truth.left_diameter, truth.right_diameter, truth.track_width};
  Outcome outcome;
  for (std::size_t k = 0; k < kLengths; ++k) {
    const Quantity& q = calibration.parameters[k].second;
    outcome.relative_error[k] = (q.value - values[k]) / values[k];
    outcome.sigmas[k] = (q.value - values[k]) / q.std;
  }
  return outcome;
}

TEST(Accuracy, twenty_robots_within_a_tenth_of_a_percent_and_honest_deviations) {
  constexpr std::uint64_t kRuns = 20;
  std::array<double, kLengths> error{};
  std::array<double, kLengths> sigmas{};
  for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kRuns; ++seed) {
    const sim::SimulatedRun run = four_minutes(seed);
    const Calibration result = calib::solve({&run.recording, 1}, {});
    ASSERT_NE(result.verdict, Verdict::refused) << "seed " << seed << ": " << result.reasons[0];
    EXPECT_TRUE(result.effects.empty()) << "seed " << seed << " got " << result.effects[0].name;
    EXPECT_FALSE(result.unexplained.has_value()) << "seed " << seed;
    const Outcome outcome = compare(result, run.truth);
    for (std::size_t k = 0; k < kLengths; ++k) {
      error[k] += std::pow(outcome.relative_error[k], 2) / kRuns;
      sigmas[k] += std::pow(outcome.sigmas[k], 2) / kRuns;
    }
  }
  static constexpr const char* kNames[] = {"left wheel diameter", "right wheel diameter", "track width"};
  for (std::size_t k = 0; k < kLengths; ++k) {
    RecordProperty(std::string(kNames[k]) + " rms", std::to_string(std::sqrt(error[k])));
    std::printf("%s: error %.4f %% RMS, %.2f stated deviations RMS\n", kNames[k], 100.0 * std::sqrt(error[k]),
                std::sqrt(sigmas[k]));
    EXPECT_LT(std::sqrt(error[k]), 1e-3) << kNames[k];
    EXPECT_GT(std::sqrt(sigmas[k]), 0.5) << kNames[k] << ": stated deviation more than twice the scatter";
    EXPECT_LT(std::sqrt(sigmas[k]), 2.0) << kNames[k] << ": stated deviation less than half the scatter";
  }
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
  for (const double sigma : compare(result, run.truth).sigmas) EXPECT_LT(std::abs(sigma), 4.0);
}

INSTANTIATE_TEST_SUITE_P(Simulated, NamesTheEffect,
                         ::testing::Values(Injected{"rim_growth", 0.012, "speed_dependent_radius"},
                                           Injected{"turn_drag", 0.006, "turn_direction_asymmetry"},
                                           Injected{"gear_play", 0.05, "backlash"},
                                           Injected{"cover_glass", 0.03, "range_bias"},
                                           Injected{"leaning_head", 0.07, "lidar_tilt"},
                                           Injected{"head_disc_off_centre", 0.02, "bearing"}),
                         [](const auto& tested) { return std::string(tested.param.name); });

}  // namespace
}  // namespace odomcalib
