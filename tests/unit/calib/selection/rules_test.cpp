// The rules of the search, their groups, and searches from which some are left out.
#include "calib/selection/rules.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "tests/unit/calib/selection/selection_support.hpp"

namespace odomcalib::calib::selection::rules_test {
namespace {

TEST(Rules, stand_once_each_in_the_order_of_their_enumeration) {
  ASSERT_EQ(rule_table().size(), kRules);
  ASSERT_EQ(rule_group_table().size(), kRuleGroups);
  std::set<std::string> names;
  for (std::size_t k = 0; k < kRules; ++k) {
    EXPECT_EQ(static_cast<std::size_t>(rule_table()[k].rule), k) << rule_table()[k].name;
    names.insert(rule_table()[k].name);
  }
  for (std::size_t k = 0; k < kRuleGroups; ++k) {
    EXPECT_EQ(static_cast<std::size_t>(rule_group_table()[k].group), k) << rule_group_table()[k].name;
    names.insert(rule_group_table()[k].name);
  }
  EXPECT_EQ(names.size(), kRules + kRuleGroups) << "one name for two";
}

TEST(Rules, belong_to_one_group_each) {
  RuleBits all;
  for (const RuleGroupRow& row : rule_group_table()) {
    EXPECT_GT(rules_of(row.group).count(), 1U) << row.name;
    EXPECT_TRUE((all & rules_of(row.group)).none()) << row.name;
    all |= rules_of(row.group);
  }
  EXPECT_TRUE(all.all());
}

TEST(Rules, are_named_alone_or_by_their_group) {
  EXPECT_EQ(rules_named("few_bends").value_or(RuleBits()).count(), 1U);
  EXPECT_EQ(rules_named("wrong_shape"), rules_of(RuleGroup::wrong_shape));
  EXPECT_FALSE(rules_named("no such rule"));
}

TEST(RuleSet, lacks_what_was_left_out_and_nothing_else) {
  const RuleSet fewer = RuleSet().without(rules_of(RuleGroup::wrong_shape)).without(Rule::significance);
  EXPECT_FALSE(fewer.has(Rule::few_bends));
  EXPECT_FALSE(fewer.has(Rule::best_shape));
  EXPECT_FALSE(fewer.has(Rule::significance));
  EXPECT_TRUE(fewer.has(Rule::stricter_level));
}

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
