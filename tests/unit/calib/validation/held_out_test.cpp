// Residual and errors on data that was not fitted.
#include "calib/validation/held_out.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/validation/window_errors.hpp"

namespace odomcalib::calib::validation::held_out_test {
namespace {

TEST(Improvement, is_plain_where_nine_of_ten_drives_gain) {
  EXPECT_TRUE((Improvement{0.9, 0.99, 0.82}).is_plain());
  EXPECT_TRUE((Improvement{0.84, 0.98, 0.48}).is_plain()) << "whatever the other side is";
  EXPECT_TRUE((Improvement{0.9, 1.02, 0.8}).is_plain());
  EXPECT_FALSE((Improvement{0.97, 1.03, 0.91}).is_plain());
  EXPECT_FALSE((Improvement{1.0, 1.0, 1.0}).is_plain());
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
}  // namespace odomcalib::calib::validation::held_out_test
