// What repeats itself as something rolls that no encoder sees.
#include <gtest/gtest.h>

#include "calib/selection/rolling_waves.hpp"
#include "calib/selection/search.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/curve_effect.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::selection {
namespace {

/// A type of its own: other tests print curves without this.
struct Wave {
  terms::Curve curve;
};

std::ostream& operator<<(std::ostream& out, const Wave& wave) {
  return out << to_string(wave.curve.law.variable);
}

/// @param all the range of the variable, in the unit of the period
Wave wave_of(const vehicle::Law& law, double all, double period) {
  return {on_basis({law, 0.0, all}, terms::Cycle{period})};
}

double period_of(const terms::Curve& wave) { return std::get<terms::Cycle>(wave.basis).period; }

class RollingWaves : public testing::TestWithParam<Wave> {};

TEST_P(RollingWaves, are_found_with_their_length) {
  const vehicle::DriveModel model = jerky_model();
  const SearchResult result = searched(measured(model, {make_curve_effect(GetParam().curve)}, {0.03, -0.02}));
  EXPECT_TRUE(result.findings.empty()) << result.findings.front().effect->name();
  ASSERT_EQ(result.curves.size(), 1U) << "seed " << kSeed;
  const terms::Curve& found = result.curves.front().curve;
  EXPECT_EQ(found.law, GetParam().curve.law) << result.curves.front().effect->name();
  EXPECT_NEAR(period_of(found), period_of(GetParam().curve), 0.02 * period_of(GetParam().curve));
  EXPECT_EQ(result.curves.front().effect->storage(), vehicle::Storage::nowhere)
      << "the next drive begins at another phase";
}

/// A caster that wobbles, and belts that go round once in 1.7 and 2.6 turns of their wheels.
INSTANTIATE_TEST_SUITE_P(
    Curve, RollingWaves,
    testing::Values(wave_of({vehicle::Variable::distance, vehicle::Carrier::yaw_path}, 100.0, 0.41),
                    wave_of({vehicle::Variable::left_phase, vehicle::Carrier::left_travel}, 1000.0,
                            1.7 * 2.0 * math::kPi),
                    wave_of({vehicle::Variable::right_phase, vehicle::Carrier::right_travel}, 1000.0,
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
    if (!candidate.curve) names.push_back(candidate.key);
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
  const terms::Curve caster =
      on_basis({{vehicle::Variable::distance, vehicle::Carrier::yaw_path}, 0.0, 100.0}, terms::Cycle{0.41});
  EXPECT_TRUE(names_beside({make_curve_effect(caster)}, {0.03, -0.02}, {}).empty());
}

}  // namespace
}  // namespace odomcalib::calib::selection
