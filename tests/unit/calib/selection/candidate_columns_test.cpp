// Changes of the residual by candidates, alone and beside others.
#include "calib/selection/candidate_columns.hpp"

#include <gtest/gtest.h>

#include "calib/terms/candidate_smooths.hpp"
#include "calib/terms/smooth_term_on_drives.hpp"
#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::selection::candidate_columns_test {
namespace {

TEST(CandidateColumns, of_a_smooth_term_do_not_depend_on_those_before_it) {
  const vehicle::DriveModel model = stopping_model();
  const measurement::FitData data = measured(model, {}, {});
  const auto fit = estimation::fit_joint({&data, 1}, {}, vehicle::to_vector(kBase));
  ASSERT_TRUE(fit) << "seed " << kSeed;
  const vehicle::DriveModel* const models[] = {&model};
  std::vector<Candidate> candidates;
  for (const terms::SmoothTerm& smooth : as_of_the_drive(terms::candidate_smooths(models), models))
    if (!terms::basis_as<terms::Cycle>(smooth)) candidates.push_back(candidate_of(smooth));
  ASSERT_GT(candidates.size(), 100U);
  const auto together = candidate_columns({&data, 1}, {}, fit.value(), candidates);
  for (std::size_t k = 0; k < candidates.size(); k += 3) {
    const auto alone = candidate_columns({&data, 1}, {}, fit.value(), {candidates[k]});
    EXPECT_EQ(alone.front(), together[k]) << candidates[k].key;
  }
}

TEST(CandidateColumns, smooth_terms_have_the_same_mean_together_and_alone) {
  const vehicle::DriveModel model = lively_model();
  const vehicle::DriveModel* const models[] = {&model};
  const std::vector<terms::SmoothTerm> smooths = terms::candidate_smooths(models);
  const auto together = as_of_the_drive(smooths, models);
  ASSERT_EQ(together.size(), smooths.size());
  std::size_t with_mean = 0;
  for (std::size_t k = 0; k < smooths.size(); ++k) {
    EXPECT_EQ(together[k], as_of_the_drive(smooths[k], models)) << k;
    if (!together[k].mean.empty()) ++with_mean;
  }
  EXPECT_GT(with_mean, 50U);
}

}  // namespace
}  // namespace odomcalib::calib::selection::candidate_columns_test
