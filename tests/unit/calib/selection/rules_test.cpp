// The rules of the search, and searches from which some are left out.
#include "calib/selection/rules.hpp"

#include <gtest/gtest.h>

#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::selection::rules_test {
namespace {

TEST(RuleSet, notes_what_was_consulted) {
  RuleBits consulted;
  EXPECT_TRUE(RuleSet().noted_in(consulted).has(Rule::exclusions));
  EXPECT_EQ(consulted, RuleBits().set(static_cast<std::size_t>(Rule::exclusions)));
}

/// Where nothing is missing, chance alone gets as far as cross-validation.
TEST(Significance, keeps_chance_from_being_considered) {
  const vehicle::DriveModel model = lively_model();
  const measurement::FitData data = measured(model, {}, {});
  EXPECT_TRUE(searched(data).considered.empty()) << "seed " << kSeed;
  EXPECT_FALSE(searched(data, RuleSet().without(Rule::significance)).considered.empty()) << "seed " << kSeed;
}

}  // namespace
}  // namespace odomcalib::calib::selection::rules_test
