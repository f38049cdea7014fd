// The rules of the search, each with what it protects against, and the set of them that holds. All of them
// hold but in an ablation, which leaves out one at a time (docs/developer/selection-rules.md).
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
  // Conditions on its score.
  significance,
  hopeless_waves,
  // Conditions on its gain.
  worthwhile_gain,
  certain_gain,
  choice_held_out,
  gain_in_most_drives,
  drives_not_worse,
  enough_explained,
  stricter_level,
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
  median_threshold,
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

/// One row of the table.
struct RuleRow {
  Rule rule;
  const char* name;  ///< as `odomcalib-blind --without-rule` takes it
  const char* protects_against;
};

/// Every rule once, in the order of the enumeration.
std::span<const RuleRow> rule_table();
/// nullopt when there is none of that name.
std::optional<Rule> rule_from(const std::string& name);

using RuleBits = std::bitset<kRules>;

/// The rules that hold. Each is consulted last of what decides, so that one that was never consulted changes
/// nothing.
class RuleSet {
 public:
  [[nodiscard]] bool has(Rule rule) const {
    if (consulted_ != nullptr) consulted_->set(static_cast<std::size_t>(rule));
    return !left_out_.test(static_cast<std::size_t>(rule));
  }
  [[nodiscard]] RuleSet without(Rule rule) const {
    RuleSet fewer = *this;
    fewer.left_out_.set(static_cast<std::size_t>(rule));
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
