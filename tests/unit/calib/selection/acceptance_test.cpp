// Conditions for adding a candidate: score, size, held-out error.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "calib/selection/candidate.hpp"
#include "calib/selection/cross_validation.hpp"
#include "calib/selection/plausibility.hpp"
#include "calib/selection/score.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/smooth_term_effect.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::selection::acceptance_test {
namespace {

/// A fit whose last parameters are those of the effect.
estimation::FitResult fit_with(const std::vector<double>& values, double deviation) {
  estimation::FitResult fit;
  fit.parameters = vehicle::to_vector(kBase, values.size());
  std::copy(values.begin(), values.end(), fit.parameters.data() + vehicle::kBaseCount);
  fit.covariance =
      deviation * deviation * Eigen::MatrixXd::Identity(fit.parameters.size(), fit.parameters.size());
  return fit;
}

TEST(Plausibility, bounds_size_and_need_are_judged_both_ways) {
  const auto effect = terms::find_effect("speed_dependent_radius");
  EXPECT_EQ(impossibility(*effect, fit_with({0.02, 0.0}, 1e-3)), "");
  EXPECT_EQ(impossibility(*effect, fit_with({1.3, 0.0}, 1e-3)),
            "kappa of 1.3 s/m is outside its physical range");
  EXPECT_NE(impossibility(*effect, fit_with({std::nan(""), 0.0}, 1e-3)), "");
  EXPECT_FALSE(is_negligible(*effect, fit_with({0.002, 0.0}, 1e-3)));
  EXPECT_TRUE(is_negligible(*effect, fit_with({0.001, 0.0}, 1e-3)));
  EXPECT_FALSE(is_superfluous(*effect, vehicle::kBaseCount, fit_with({0.003, 0.0}, 1e-3)));
  EXPECT_TRUE(is_superfluous(*effect, vehicle::kBaseCount, fit_with({0.001, 0.0}, 1e-3)));
  EXPECT_FALSE(spoils_base(*effect, fit_with({0.0, 0.0}, 1e-3), fit_with({0.0, 0.0}, 2.9e-3)));
  EXPECT_TRUE(spoils_base(*effect, fit_with({0.0, 0.0}, 1e-3), fit_with({0.0, 0.0}, 3.1e-3)));
  EXPECT_FALSE(spoils_base(*effect, fit_with({0.0, 0.0}, 1e-5), fit_with({0.0, 0.0}, 7e-5)))
      << "still less than a thousandth of a length";
  EXPECT_TRUE(spoils_base(*effect, fit_with({0.0, 0.0}, 1e-5), fit_with({0.0, 0.0}, 9e-5)));
  EXPECT_FALSE(spoils_base(*terms::find_effect("drift_with_time"), fit_with({0.0, 0.0}, 1e-3),
                           fit_with({0.0, 0.0}, 9e-3)));
}

TEST(Plausibility, no_filter_sharpens_but_beside_a_delay_it_may_seem_to) {
  const auto late = terms::find_effect("time_offset");
  EXPECT_EQ(contradiction(*late, fit_with({1e-3, -1e-3}, 1e-4)), "a filter does not sharpen");
  EXPECT_EQ(contradiction(*late, fit_with({1e-3, 1e-3}, 1e-4)), "");
  EXPECT_EQ(contradiction(*late, fit_with({0.02, -1e-3}, 1e-4)), "");
  EXPECT_EQ(contradiction(*terms::find_effect("backlash"), fit_with({1e-3, -1e-3, 0.0}, 1e-4)), "");
}

TEST(Plausibility, the_shape_of_an_effect_is_no_size) {
  EXPECT_TRUE(is_negligible(*terms::find_effect("tick_loss"), fit_with({1e-4, 0.0, 0.4, 0.02}, 1e-3)));
  EXPECT_FALSE(is_negligible(*terms::find_effect("tick_loss"), fit_with({0.01, 0.0, 0.4, 0.02}, 1e-3)));
}

TEST(Score, tail_of_chi_squared_agrees_with_tables) {
  EXPECT_NEAR(chi_squared_tail(3.841, 1), 0.05, 1e-4);
  EXPECT_NEAR(chi_squared_tail(16.812, 6), 0.01, 1e-5);
  EXPECT_EQ(chi_squared_tail(0.0, 3), 1.0);
  EXPECT_EQ(chi_squared_tail(7.0, 0), 1.0);
}

TEST(CrossValidation, what_makes_drives_worse_is_refused) {
  const vehicle::DriveModel model = lively_model();
  measurement::FitData data = measured(model, {}, {});
  for (measurement::SensorPair& pair : data.pairs) pair.follows_previous = &pair != &data.pairs.front();
  const FitTask task{{&data, 1}, std::vector<bool>(vehicle::kBaseCount, false)};
  const auto fit = estimation::fit_joint(task.data, {}, vehicle::to_vector(kBase));
  ASSERT_TRUE(fit) << "seed " << kSeed;
  const FittedModel right{{}, fit.value()};
  FittedModel wrong = right;
  wrong.fit.parameters(vehicle::kTrackWidth) *= 1.02;
  EXPECT_TRUE(change_of_drives(task, right, wrong).is_spoilt);
  EXPECT_FALSE(change_of_drives(task, wrong, right).is_spoilt);
  EXPECT_FALSE(change_of_drives(task, right, right).is_spoilt);
  EXPECT_GT(change_of_drives(task, right, wrong).ratio, 1.0);
  EXPECT_LT(change_of_drives(task, wrong, right).ratio, 1.0);
  EXPECT_EQ(change_of_drives(task, right, right).ratio, 1.0);
}

}  // namespace
}  // namespace odomcalib::calib::selection::acceptance_test
