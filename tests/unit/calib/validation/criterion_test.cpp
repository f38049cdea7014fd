// Each criterion on both sides of its number.
#include "calib/validation/criterion.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace odomcalib::calib::validation::criterion_test {
namespace {

HeldOut held_out(const std::array<double, 3>& rms, const std::array<double, 3>& bounded) {
  HeldOut residual;
  residual.rms = rms;
  residual.bounded = bounded;
  residual.pairs = 100;
  return residual;
}

const HeldOut kBefore = held_out({1.0, 2.0, 3.0}, {1.0, 2.0, 3.0});

TEST(Criterion, clearly_better_asks_all_components_together) {
  EXPECT_TRUE(is_clearly_better(kBefore, held_out({1.0, 2.0, 3.0}, {0.94, 2.0, 3.0})));
  EXPECT_FALSE(is_clearly_better(kBefore, held_out({1.0, 2.0, 3.0}, {0.96, 2.0, 3.0})));
  EXPECT_TRUE(is_clearly_better(kBefore, held_out({1.0, 2.0, 3.0}, {0.8, 2.2, 3.0})));
  EXPECT_FALSE(is_clearly_better(kBefore, held_out({1.0, 2.0, 3.0}, {0.8, 2.4, 3.0})));
}

TEST(Criterion, clearly_better_counts_outliers) {
  EXPECT_FALSE(is_clearly_better(kBefore, held_out({0.5, 1.0, 1.5}, {1.0, 2.0, 3.0})));
}

TEST(Criterion, clearly_better_needs_both_residuals) {
  const HeldOut after = held_out({0.5, 1.0, 1.5}, {0.5, 1.0, 1.5});
  EXPECT_TRUE(is_clearly_better(kBefore, after));
  EXPECT_FALSE(is_clearly_better(std::nullopt, after));
  EXPECT_FALSE(is_clearly_better(kBefore, std::nullopt));
}

TEST(Criterion, worse_in_any_component_is_worse) {
  EXPECT_FALSE(is_worse(kBefore, held_out({1.04, 2.08, 3.12}, {9.0, 9.0, 9.0})));
  EXPECT_TRUE(is_worse(kBefore, held_out({1.06, 1.0, 1.0}, {0.1, 0.1, 0.1})));
  EXPECT_TRUE(is_worse(kBefore, held_out({0.5, 1.0, 3.18}, {0.1, 0.1, 0.1})));
}

TEST(Criterion, a_residual_that_is_lost_is_worse) {
  EXPECT_TRUE(is_worse(kBefore, std::nullopt));
  EXPECT_FALSE(is_worse(std::nullopt, kBefore));
  EXPECT_FALSE(is_worse(std::nullopt, std::nullopt));
}

TEST(Criterion, p_value_is_that_of_chi_squared_with_one_degree_of_freedom) {
  // 3.8415 is the 95 % quantile.
  const double lower = std::exp(-3.8415 / 200.0);
  EXPECT_NEAR(p_value_of(kBefore, held_out({}, {lower, 2.0, 3.0})), 0.05, 1e-5);
  EXPECT_LT(p_value_of(kBefore, held_out({}, {0.8, 2.0, 3.0})), 1e-9);
  EXPECT_EQ(p_value_of(kBefore, kBefore), 1.0);
  EXPECT_EQ(p_value_of(kBefore, held_out({}, {1.2, 2.0, 3.0})), 1.0);
}

TEST(Criterion, plain_is_beyond_four_deviations_of_either_sign) {
  EXPECT_TRUE(is_plain({4.1, 1.0}));
  EXPECT_TRUE(is_plain({-8.2, 4.0}));
  EXPECT_FALSE(is_plain({3.9, 1.0}));
  EXPECT_FALSE(is_plain({-7.8, 4.0}));
  EXPECT_FALSE(is_plain({4.1, 1.0}, 4.2));
  EXPECT_TRUE(is_plain({4.1, 1.0}, 4.0));
}

TEST(Criterion, idle_is_within_four_deviations_or_negligible) {
  EXPECT_TRUE(is_idle({-3.9, 1.0}, 0.0));
  EXPECT_FALSE(is_idle({-4.1, 1.0}, 0.0));
  EXPECT_TRUE(is_idle({2.9e-3, 1e-10}, 3e-3));
  EXPECT_FALSE(is_idle({3.1e-3, 1e-10}, 3e-3));
}

TEST(Criterion, a_marker_is_mounted_elsewhere_where_any_component_is_plain) {
  const Estimate zero{0.0, 1e-10};
  EXPECT_FALSE(is_mounted_elsewhere({zero, zero, zero}));
  EXPECT_TRUE(is_mounted_elsewhere({{6e-4, 1e-10}, zero, zero}));
  EXPECT_TRUE(is_mounted_elsewhere({zero, {-6e-4, 1e-10}, zero}));
  EXPECT_TRUE(is_mounted_elsewhere({zero, zero, {2.1e-3, 1e-10}}));
  EXPECT_FALSE(is_mounted_elsewhere({{4e-4, 1e-10}, {4e-4, 1e-10}, {1.9e-3, 1e-10}}));
  EXPECT_FALSE(is_mounted_elsewhere({{3.9e-3, 1e-6}, zero, zero}));
}

TEST(Criterion, a_marker_sits_where_it_should_unless_the_motion_knows_all_of_its_place) {
  const Estimate far{0.1, 1e-10};
  EXPECT_TRUE(is_mounted_elsewhere({far, {0.0, 4.9e-3 * 4.9e-3}, {0.0, 1.9e-2 * 1.9e-2}}));
  EXPECT_FALSE(is_mounted_elsewhere({far, {0.0, 5.1e-3 * 5.1e-3}, {0.0, 1e-10}}));
  EXPECT_FALSE(is_mounted_elsewhere({far, {0.0, 1e-10}, {0.0, 2.1e-2 * 2.1e-2}}));
}

TEST(Criterion, matches_slide_from_two_deviations_on) {
  EXPECT_FALSE(is_sliding(1.99));
  EXPECT_TRUE(is_sliding(2.0));
}

TEST(Criterion, estimates_agree_within_four_deviations_of_both) {
  EXPECT_TRUE(agrees({0.0, 9.0}, {19.9, 16.0}));
  EXPECT_FALSE(agrees({0.0, 9.0}, {20.1, 16.0}));
  EXPECT_FALSE(agrees({20.1, 9.0}, {0.0, 16.0}));
}

TEST(Criterion, what_confirms_must_know_better) {
  const Comparison sharper{{1.0, 1.0}, {1.1, 0.5}, true}, blunter{{1.0, 1.0}, {1.1, 3.0}, true};
  EXPECT_TRUE(confirms_and_knows_better(std::array{sharper}));
  EXPECT_FALSE(confirms_and_knows_better(std::array{blunter}));
  EXPECT_FALSE(confirms_and_knows_better(std::array{sharper, blunter}));
  EXPECT_TRUE(confirms_and_knows_better(std::array{sharper, sharper, blunter}));
}

TEST(Criterion, what_knows_better_must_confirm) {
  const Comparison sharper{{1.0, 1.0}, {1.1, 0.1}, true}, apart{{1.0, 1.0}, {9.0, 1.0}, false};
  const Comparison blunter_beside{{1.0, 1.0}, {1.1, 99.0}, false},
      not_estimated{{1.0, 0.0}, {9.0, 1.0}, true};
  EXPECT_FALSE(confirms_and_knows_better(std::array{sharper, apart}));
  EXPECT_TRUE(confirms_and_knows_better(std::array{sharper, blunter_beside}));
  EXPECT_TRUE(confirms_and_knows_better(std::array{sharper, not_estimated}));
}

}  // namespace
}  // namespace odomcalib::calib::validation::criterion_test
