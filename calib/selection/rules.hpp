// The rules of the search, each with what it protects against, in groups that guard against the same mistake,
// and the set of them that holds. All of them hold but in an ablation, which leaves out a rule or a group at
// a time (docs/developer/selection-rules.md).
#pragma once

#include <bitset>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace odomcalib::calib::selection {

enum class Rule : std::size_t {
  // Conditions for a candidate to be plausible.
  sway_above_ticks,
  physical_range,
  size_that_matters,
  no_contradiction,
  base_determined,
  // Conditions on its score and its gain.
  significance,
  certain_gain,
  choice_held_out,
  gain_in_most_drives,
  drives_not_worse,
  enough_explained,
  // Choice of the one that is meant among several candidates.
  clock_before_name,
  unnamed_clock,
  names_before_smooth_terms,
  smooth_term_before_name,
  rest_of_a_name,
  name_against_smooth_term,
  nearly_all_explained,
  smooth_term_for_name,
  exclusions,
  backward_elimination,
  few_terms,
  close_competitors,
  // How a candidate is fitted.
  wider_noise,
  larger_prior,
  centred_term,
  other_shape,
  best_shape,
  credible_shape,
  few_bends,
  hyperparameter_penalty,
  // Errors of the lidar, before any term of the wheels.
  lidar_significance,
  lidar_gain,
  lidar_size,
  lidar_part_of_an_error,
  lidar_elimination,
  range_gain,
};
inline constexpr std::size_t kRules = static_cast<std::size_t>(Rule::range_gain) + 1;

/// Mistakes that several rules guard against.
enum class RuleGroup : std::size_t {
  chance,
  held_out,
  too_small,
  impossible,
  wrong_name,
  second_term,
  look_alikes,
  wrong_shape,
  refused_effect,
};
inline constexpr std::size_t kRuleGroups = static_cast<std::size_t>(RuleGroup::refused_effect) + 1;

/// One row of the table of rules.
struct RuleRow {
  Rule rule;
  RuleGroup group;
  const char* name;  ///< as `odomcalib-blind --without-rule` takes it
  const char* protects_against;
};

/// One row of the table of groups.
struct RuleGroupRow {
  RuleGroup group;
  const char* name;  ///< as `odomcalib-blind --without-rule` takes it; no rule has the same
  const char* protects_against;
};

using RuleBits = std::bitset<kRules>;

/// Every rule once, in the order of the enumeration.
std::span<const RuleRow> rule_table();
/// Every group once, in the order of the enumeration.
std::span<const RuleGroupRow> rule_group_table();
const char* name_of(RuleGroup group);
/// The rules of one group.
RuleBits rules_of(RuleGroup group);
/// The rule of that name, or all rules of the group of that name; nullopt when there is neither.
std::optional<RuleBits> rules_named(const std::string& name);

/// The rules that hold. Each is consulted last of what decides, so that one that was never consulted changes
/// nothing.
class RuleSet {
 public:
  [[nodiscard]] bool has(Rule rule) const {
    if (consulted_ != nullptr) consulted_->set(static_cast<std::size_t>(rule));
    return !left_out_.test(static_cast<std::size_t>(rule));
  }
  [[nodiscard]] RuleSet without(Rule rule) const {
    return without(RuleBits().set(static_cast<std::size_t>(rule)));
  }
  [[nodiscard]] RuleSet without(const RuleBits& rules) const {
    RuleSet fewer = *this;
    fewer.left_out_ |= rules;
    return fewer;
  }
  /// @param consulted outlives the set; not to be shared between threads
  [[nodiscard]] RuleSet noted_in(RuleBits& consulted) const {
    RuleSet noted = *this;
    noted.consulted_ = &consulted;
    return noted;
  }

 private:
  RuleBits left_out_;
  RuleBits* consulted_ = nullptr;
};

}  // namespace odomcalib::calib::selection
