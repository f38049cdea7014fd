#include "calib/selection/rules.hpp"

#include <array>

namespace odomcalib::calib::selection {
namespace {

constexpr std::array kTable = {
    RuleRow{Rule::sway_above_ticks, RuleGroup::impossible, "sway_above_ticks",
            "taking what coarse ticks hide for a mast that sways"},
    RuleRow{Rule::physical_range, RuleGroup::impossible, "physical_range", "sizes that no robot has"},
    RuleRow{Rule::size_that_matters, RuleGroup::too_small, "size_that_matters",
            "reports of what nobody would notice"},
    RuleRow{Rule::no_contradiction, RuleGroup::impossible, "no_contradiction",
            "parameters of one effect that exclude each other"},
    RuleRow{Rule::base_determined, RuleGroup::impossible, "base_determined",
            "trading a known geometry for a guess in poor drives"},
    RuleRow{Rule::significance, RuleGroup::chance, "significance", "candidates that chance scores as high"},
    RuleRow{Rule::certain_gain, RuleGroup::held_out, "certain_gain",
            "terms whose gain on held-out drives is chance"},
    RuleRow{Rule::choice_held_out, RuleGroup::held_out, "choice_held_out",
            "choosing a term by the data that judge it"},
    RuleRow{Rule::gain_in_most_drives, RuleGroup::held_out, "gain_in_most_drives",
            "smooth terms that help in this drive and not in the next"},
    RuleRow{Rule::drives_not_worse, RuleGroup::held_out, "drives_not_worse",
            "a lower residual and worse turns, straights or drives"},
    RuleRow{Rule::enough_explained, RuleGroup::too_small, "enough_explained",
            "smooth terms of one covariate for an effect of two"},
    RuleRow{Rule::clock_before_name, RuleGroup::look_alikes, "clock_before_name",
            "a small delay that passes for play or slip"},
    RuleRow{Rule::unnamed_clock, RuleGroup::too_small, "unnamed_clock",
            "reports of a delay of a millisecond"},
    RuleRow{Rule::names_before_smooth_terms, RuleGroup::wrong_name, "names_before_smooth_terms",
            "names for what a smooth term has left"},
    RuleRow{Rule::smooth_term_before_name, RuleGroup::wrong_name, "smooth_term_before_name",
            "a name of another effect that explains a part"},
    RuleRow{Rule::rest_of_a_name, RuleGroup::second_term, "rest_of_a_name",
            "a second name for the rest of the first"},
    RuleRow{Rule::name_against_smooth_term, RuleGroup::wrong_name, "name_against_smooth_term",
            "flexible names that fit anything"},
    RuleRow{Rule::nearly_all_explained, RuleGroup::wrong_name, "nearly_all_explained",
            "right names refused for a small rest"},
    RuleRow{Rule::smooth_term_for_name, RuleGroup::wrong_name, "smooth_term_for_name",
            "wrong names that were taken early"},
    RuleRow{Rule::exclusions, RuleGroup::second_term, "exclusions", "a second term for what a name covers"},
    RuleRow{Rule::backward_elimination, RuleGroup::second_term, "backward_elimination",
            "terms that a later term made superfluous"},
    RuleRow{Rule::few_terms, RuleGroup::second_term, "few_terms",
            "models that grow with every oddity of a drive"},
    RuleRow{Rule::close_competitors, RuleGroup::look_alikes, "close_competitors",
            "one name where the data cannot separate two"},
    RuleRow{Rule::wider_noise, RuleGroup::refused_effect, "wider_noise",
            "robust weights that take an effect for failed matches"},
    RuleRow{Rule::larger_prior, RuleGroup::refused_effect, "larger_prior", "shrinking large effects"},
    RuleRow{Rule::centred_term, RuleGroup::refused_effect, "centred_term",
            "refusing terms that the drive cannot separate from slow motion"},
    RuleRow{Rule::other_shape, RuleGroup::refused_effect, "other_shape",
            "refusing terms that were found too coarse"},
    RuleRow{Rule::best_shape, RuleGroup::wrong_shape, "best_shape", "shapes too coarse or too fine"},
    RuleRow{Rule::credible_shape, RuleGroup::impossible, "credible_shape",
            "shapes that take a length, or that no robot has"},
    RuleRow{Rule::few_bends, RuleGroup::wrong_shape, "few_bends", "bends that stand for single manoeuvres"},
    RuleRow{Rule::hyperparameter_penalty, RuleGroup::look_alikes, "hyperparameter_penalty",
            "names that win by their choice of shapes"},
    RuleRow{Rule::lidar_significance, RuleGroup::chance, "lidar_significance",
            "errors of the lidar that chance scores as high"},
    RuleRow{Rule::lidar_gain, RuleGroup::held_out, "lidar_gain",
            "errors of the lidar that other scans do not show"},
    RuleRow{Rule::lidar_size, RuleGroup::too_small, "lidar_size",
            "errors of the lidar that matter to nobody, or that no device has"},
    RuleRow{Rule::lidar_part_of_an_error, RuleGroup::wrong_name, "lidar_part_of_an_error",
            "a name for a part of what the lidar does"},
    RuleRow{Rule::lidar_elimination, RuleGroup::second_term, "lidar_elimination",
            "names of the lidar that a later one made superfluous"},
    RuleRow{Rule::range_gain, RuleGroup::held_out, "range_gain",
            "errors of the ranges that stand for the map's"},
};
static_assert(kTable.size() == kRules);

constexpr std::array kGroups = {
    RuleGroupRow{RuleGroup::chance, "chance", "terms that chance scores as high"},
    RuleGroupRow{RuleGroup::held_out, "held_out", "terms that hold in these data and not in the next"},
    RuleGroupRow{RuleGroup::too_small, "too_small", "reports of what matters to nobody"},
    RuleGroupRow{RuleGroup::impossible, "impossible",
                 "what no robot does, or what this drive cannot separate from a length"},
    RuleGroupRow{RuleGroup::wrong_name, "wrong_name",
                 "a name for what is something else, or none for what has one"},
    RuleGroupRow{RuleGroup::second_term, "second_term", "a second term for what the first covers"},
    RuleGroupRow{RuleGroup::look_alikes, "look_alikes", "the wrong one of several that look alike"},
    RuleGroupRow{RuleGroup::wrong_shape, "wrong_shape", "the right term in the wrong shape"},
    RuleGroupRow{RuleGroup::refused_effect, "refused_effect", "refusing effects that are there"},
};
static_assert(kGroups.size() == kRuleGroups);

}  // namespace

std::span<const RuleRow> rule_table() { return kTable; }
std::span<const RuleGroupRow> rule_group_table() { return kGroups; }

const char* name_of(RuleGroup group) { return kGroups.at(static_cast<std::size_t>(group)).name; }

RuleBits rules_of(RuleGroup group) {
  RuleBits rules;
  for (const RuleRow& row : kTable)
    if (row.group == group) rules.set(static_cast<std::size_t>(row.rule));
  return rules;
}

std::optional<RuleBits> rules_named(const std::string& name) {
  for (const RuleRow& row : kTable)
    if (name == row.name) return RuleBits().set(static_cast<std::size_t>(row.rule));
  for (const RuleGroupRow& row : kGroups)
    if (name == row.name) return rules_of(row.group);
  return std::nullopt;
}

}  // namespace odomcalib::calib::selection
