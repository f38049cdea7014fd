// Score tests of candidates, and what may happen to these while the table stands.
#include "calib/selection/score.hpp"

#include <gtest/gtest.h>

#include "calib/terms/catalogue.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::selection::score_test {
namespace {

Candidate named(const std::string& name) { return {terms::find_effect(name), std::nullopt, name}; }

TEST(ScoreTable, is_of_the_candidates_as_they_were_when_it_was_made) {
  const vehicle::DriveModel model = lively_model();
  const measurement::FitData data = measured(model, {terms::find_effect("turn_direction_asymmetry")}, {2e-3});
  const auto fit = estimation::fit_joint({&data, 1}, {}, vehicle::to_vector(kBase));
  ASSERT_TRUE(fit) << "seed " << kSeed;
  const FitTask task{{&data, 1}, std::vector<bool>(vehicle::kBaseCount, false)};
  const FittedModel basis{{}, fit.value()};
  std::vector<Candidate> candidates = {named("turn_direction_asymmetry"), named("time_offset")};
  const ScoreTable table(task, basis, candidates);
  validation::FoldFlags all{};
  all.fill(true);
  ASSERT_EQ(table.selected_without({0}, 0.001), all) << "seed " << kSeed;
  const std::vector<double> alike = table.correlations(0, {1});

  // The search gives a candidate another shape, of more parameters, and asks on.
  candidates[0] = named("direction_dependent_diameter");
  ASSERT_NE(candidates[0].effect->parameters().size(), table.scores()[0].degrees);
  EXPECT_EQ(table.selected_without({0}, 0.001), all) << "seed " << kSeed;
  EXPECT_EQ(table.correlations(0, {1}), alike);
}

}  // namespace
}  // namespace odomcalib::calib::selection::score_test
