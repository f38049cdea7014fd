// Waves that repeat as something rolls that no encoder sees.
#include <gtest/gtest.h>

#include "calib/selection/rolling_waves.hpp"
#include "calib/selection/search.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/smooth_term_effect.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::selection::rolling_wave_test {
namespace {

/// A type of its own: other tests print smooth terms without this.
struct Wave {
  terms::SmoothTerm smooth;
};

std::ostream& operator<<(std::ostream& out, const Wave& wave) {
  return out << to_string(wave.smooth.dependence.covariate);
}

/// @param all the range of the covariate, in the unit of the period
Wave wave_of(const vehicle::Dependence& dependence, double all, double period) {
  return {on_basis({dependence, 0.0, all}, terms::Cycle{period})};
}

double period_of(const terms::SmoothTerm& wave) { return std::get<terms::Cycle>(wave.basis).period; }

class RollingWaves : public testing::TestWithParam<Wave> {};

TEST_P(RollingWaves, are_found_with_their_length) {
  const vehicle::DriveModel model = jerky_model();
  const SearchResult result =
      searched(measured(model, {make_smooth_term_effect(GetParam().smooth)}, {0.03, -0.02}));
  EXPECT_TRUE(result.findings.empty()) << result.findings.front().effect->name();
  ASSERT_EQ(result.smooths.size(), 1U) << "seed " << kSeed;
  const terms::SmoothTerm& found = result.smooths.front().smooth;
  EXPECT_EQ(found.dependence, GetParam().smooth.dependence) << result.smooths.front().effect->name();
  EXPECT_NEAR(period_of(found), period_of(GetParam().smooth), 0.02 * period_of(GetParam().smooth));
  EXPECT_EQ(result.smooths.front().effect->storage(), vehicle::Storage::nowhere)
      << "the next drive begins at another phase";
}

/// A caster that wobbles, and belts that go round once in 1.7 and 2.6 turns of their wheels.
INSTANTIATE_TEST_SUITE_P(
    SmoothTerm, RollingWaves,
    testing::Values(wave_of({vehicle::Covariate::distance, vehicle::Channel::yaw_path}, 100.0, 0.41),
                    wave_of({vehicle::Covariate::left_phase, vehicle::Channel::left_travel}, 1000.0,
                            1.7 * 2.0 * math::kPi),
                    wave_of({vehicle::Covariate::right_phase, vehicle::Channel::right_travel}, 1000.0,
                            2.6 * 2.0 * math::kPi)),
    testing::PrintToStringParamName());

/// Names that the wave found competes with.
std::vector<std::string> names_beside(const vehicle::EffectList& effects, const std::vector<double>& values,
                                      const vehicle::EffectList& known) {
  const vehicle::DriveModel model = jerky_model();
  const measurement::FitData data = measured(model, effects, values);
  const auto fit =
      estimation::fit_joint({&data, 1}, known, vehicle::to_vector(kBase, vehicle::count_parameters(known)));
  EXPECT_TRUE(fit) << "seed " << kSeed;
  std::vector<std::string> names;
  for (const Candidate& candidate : rolling_waves({&data, 1}, {known, fit.value()}))
    if (!candidate.smooth) names.push_back(candidate.key);
  return names;
}

TEST(RollingWave, of_a_wheel_competes_with_the_names_of_what_goes_round_with_it) {
  const vehicle::EffectList both = terms::find_effects("wheel_eccentricity");
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(names_beside({both.back()}, {0.02, -0.01}, {}),
            std::vector<std::string>{"wheel_eccentricity/right_cos"});
  EXPECT_TRUE(names_beside({both.back()}, {0.02, -0.01}, {both.back()}).empty()) << "no wave is left";
}

TEST(RollingWave, of_the_base_has_no_name) {
  const terms::SmoothTerm caster =
      on_basis({{vehicle::Covariate::distance, vehicle::Channel::yaw_path}, 0.0, 100.0}, terms::Cycle{0.41});
  EXPECT_TRUE(names_beside({make_smooth_term_effect(caster)}, {0.03, -0.02}, {}).empty());
}

/// Waves that are proposed for a drive of 22 minutes.
std::vector<terms::SmoothTerm> waves_of_a_long_drive(const vehicle::EffectList& effects,
                                                     const std::vector<double>& values) {
  const vehicle::DriveModel model = jerky_model(1320.0);
  std::vector<vehicle::Interval> intervals;
  for (double t = 0.513; t < 1318.0; t += 0.5) intervals.push_back({t, t + 0.5});
  const measurement::FitData data = measured(model, effects, values, intervals);
  const auto fit = estimation::fit_joint({&data, 1}, {}, vehicle::to_vector(kBase));
  EXPECT_TRUE(fit) << "seed " << kSeed;
  std::vector<terms::SmoothTerm> waves;
  for (const Candidate& candidate : rolling_waves({&data, 1}, {{}, fit.value()}))
    if (candidate.smooth) waves.push_back(*candidate.smooth);
  return waves;
}

TEST(RollingWave, may_be_one_of_time_that_comes_too_often_to_be_tried_one_by_one) {
  const vehicle::Dependence left{vehicle::Covariate::time, vehicle::Channel::left_travel};
  const terms::SmoothTerm wave = wave_of(left, 1320.0, 9.3).smooth;
  const auto proposed = waves_of_a_long_drive({make_smooth_term_effect(wave)}, {0.004, -0.003});
  const auto its = std::find_if(proposed.begin(), proposed.end(),
                                [&](const terms::SmoothTerm& smooth) { return smooth.dependence == left; });
  ASSERT_NE(its, proposed.end()) << "seed " << kSeed;
  EXPECT_NEAR(period_of(*its), 9.3, 0.01);
  EXPECT_TRUE(waves_of_a_long_drive({}, {}).empty()) << "nothing comes back, seed " << kSeed;
}

}  // namespace
}  // namespace odomcalib::calib::selection::rolling_wave_test
