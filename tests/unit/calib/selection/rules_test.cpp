// The rules of the search, their groups, and searches from which some are left out.
#include "calib/selection/rules.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "calib/selection/hyperparameters.hpp"
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
  EXPECT_TRUE(fewer.has(Rule::exclusions));
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

/// Four minutes on and on at speeds that hardly change.
vehicle::DriveModel even_model() {
  wheels::WheelTrack track;
  for (int k = 0; k <= 6000; ++k) {
    const double t = 0.04 * k;
    track.t.push_back(t);
    track.left.push_back(6.0 * t + std::sin(0.3 * t));
    track.right.push_back(7.0 * t + std::sin(0.43 * t + 0.5) + 6.0 * std::sin(0.2 * t));
    track.segment.push_back(0);
  }
  const auto context = vehicle::make_context(track, kBase);
  return {std::move(track), context};
}

/// How much less a drive knows of the left wheel's radius beside a term of the wheel's travel, in the best of
/// the term's shapes: ratio of deviations; nullopt: no shape is credible.
/// @param most of the covariate, m/s or m/s^2
std::optional<double> widened_by_best_shape(const vehicle::DriveModel& model, vehicle::Covariate covariate,
                                            double most, const RuleSet& rules) {
  const terms::SmoothTerm smooth{{covariate, vehicle::Channel::left_travel}, -most, most};
  const measurement::FitData data = measured(model, {}, {});
  const auto fit = estimation::fit_joint({&data, 1}, {}, vehicle::to_vector(kBase));
  EXPECT_TRUE(fit) << "seed " << kSeed;
  const FitTask task{{&data, 1}, std::vector<bool>(vehicle::kBaseCount, false), rules};
  const auto shaped = in_best_shape(task, {{}, fit.value()}, smooth, fit.value().noise);
  const auto variance = [](const estimation::FitResult& of) {
    return of.covariance(vehicle::kLeftRadius, vehicle::kLeftRadius);
  };
  return shaped ? std::optional(std::sqrt(variance(shaped->model.fit) / variance(fit.value())))
                : std::nullopt;
}

/// A term of the speed is the radius itself where the speed hardly changes; one of the acceleration is not.
TEST(CredibleShape, keeps_a_length_known_that_a_shape_would_take) {
  const vehicle::DriveModel even = even_model(), jerky = jerky_model();
  const RuleSet anything = RuleSet().without(Rule::credible_shape);
  const auto of_speed = [&](const RuleSet& rules) {
    return widened_by_best_shape(even, vehicle::Covariate::left_speed, 0.6, rules);
  };
  EXPECT_FALSE(of_speed(RuleSet())) << "seed " << kSeed;
  EXPECT_GT(of_speed(anything).value_or(0.0), 20.0) << "seed " << kSeed;
  const auto of_acceleration = [&](const RuleSet& rules) {
    return widened_by_best_shape(jerky, vehicle::Covariate::left_acceleration, 1.0, rules);
  };
  EXPECT_LT(of_acceleration(RuleSet()).value_or(100.0), 2.0) << "seed " << kSeed;
  EXPECT_EQ(of_acceleration(RuleSet()), of_acceleration(anything)) << "seed " << kSeed;
}

}  // namespace
}  // namespace odomcalib::calib::selection::rules_test
