// Conditions for adding a candidate: score, size, held-out error.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "calib/selection/candidate.hpp"
#include "calib/selection/cross_validation.hpp"
#include "calib/selection/held_out.hpp"
#include "calib/selection/plausibility.hpp"
#include "calib/selection/score.hpp"
#include "calib/selection/window_errors.hpp"
#include "calib/terms/catalogue.hpp"
#include "calib/terms/smooth_term_effect.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::selection::acceptance_test {
namespace {

TEST(Candidate, what_must_help_over_ten_seconds) {
  const auto ratio = [](vehicle::Covariate covariate, vehicle::Channel channel) {
    const terms::SmoothTerm smooth{{covariate, channel}, -1.0, 1.0};
    return largest_ratio({make_smooth_term_effect(smooth), smooth, ""});
  };
  EXPECT_LT(ratio(vehicle::Covariate::speed, vehicle::Channel::both_travel), 1.0);
  EXPECT_LT(ratio(vehicle::Covariate::heading, vehicle::Channel::both_travel),
            ratio(vehicle::Covariate::speed, vehicle::Channel::both_travel));
  EXPECT_GT(ratio(vehicle::Covariate::left_phase, vehicle::Channel::left_travel), 1.0)
      << "cancels over whole turns of the wheel";
}

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

TEST(Improvement, is_plain_where_nine_of_ten_drives_gain) {
  EXPECT_TRUE((Improvement{0.9, 0.99, 0.82}).is_plain());
  EXPECT_TRUE((Improvement{0.84, 0.98, 0.48}).is_plain()) << "whatever the other side is";
  EXPECT_TRUE((Improvement{0.9, 1.02, 0.8}).is_plain());
  EXPECT_FALSE((Improvement{0.97, 1.03, 0.91}).is_plain());
  EXPECT_FALSE((Improvement{1.0, 1.0, 1.0}).is_plain());
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

TEST(HeldOut, two_models_are_compared_on_the_same_pairs) {
  const Eigen::Vector3d variance(1e-6, 1e-6, 1e-6), usual(1e-3, 1e-3, 1e-3), gross(1.0, 1.0, 1.0);
  std::vector<HeldOutError> before(100, {usual, variance}), after = before;
  before[0].error = after[0].error = gross;  // a failed match
  before[1].error = gross;                   // what the second model explains
  const auto of_before = held_out_residual(before, after), of_after = held_out_residual(after, before);
  ASSERT_TRUE(of_before && of_after);
  EXPECT_EQ(of_before->pairs, 99U);
  EXPECT_EQ(of_after->pairs, 99U);
  EXPECT_NEAR(of_before->rms[2], std::sqrt((1.0 + 98e-6) / 99.0), 1e-12);
  EXPECT_NEAR(of_after->rms[2], 1e-3, 1e-12);
}

TEST(HeldOut, outliers_make_no_model_look_better) {
  const Eigen::Vector3d variance(1e-6, 1e-6, 1e-6), usual(1e-3, 1e-3, 1e-3), gross(1.0, 1.0, 1.0);
  const std::vector<HeldOutError> all(100, {usual, variance});
  std::vector<HeldOutError> some(100, {0.9 * usual, variance});
  for (std::size_t k = 0; k < 20; ++k) some[k].error = gross;
  const auto of_all = held_out_residual(all, all), of_some = held_out_residual(some, some);
  ASSERT_TRUE(of_all && of_some);
  EXPECT_LT(of_some->rms[0], of_all->rms[0]);
  EXPECT_NEAR(of_all->bounded[0], 1e-3, 1e-12);
  EXPECT_NEAR(of_some->bounded[0], 1e-3 * std::sqrt(0.8 * 0.81 + 0.2 * 36.0), 1e-12);
}

TEST(WindowErrors, a_fold_that_would_not_have_chosen_keeps_its_error) {
  WindowErrors before, after;
  before.position = {1.0, 2.0, 3.0};
  before.heading = {0.1, 0.2, 0.3};
  before.fold = {0, 1, 4};
  before.block = {0, 1, 2};
  after = before;
  after.position = {0.1, 0.2, 0.3};
  const WindowErrors mixed = where_selected(before, after, {true, false, true, true, false});
  EXPECT_EQ(mixed.position, (std::vector<double>{0.1, 2.0, 3.0}));
}

}  // namespace
}  // namespace odomcalib::calib::selection::acceptance_test
