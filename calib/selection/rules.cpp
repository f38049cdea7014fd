#include "calib/selection/rules.hpp"

#include <algorithm>
#include <array>

namespace odomcalib::calib::selection {
namespace {

constexpr std::array kTable = {
    RuleRow{Rule::sway_above_ticks, "sway_above_ticks",
            "taking what coarse ticks hide for a mast that sways"},
    RuleRow{Rule::physical_range, "physical_range", "sizes that no robot has"},
    RuleRow{Rule::size_that_matters, "size_that_matters", "reports of what nobody would notice"},
    RuleRow{Rule::no_contradiction, "no_contradiction", "parameters of one effect that exclude each other"},
    RuleRow{Rule::base_determined, "base_determined", "trading a known geometry for a guess in poor drives"},
    RuleRow{Rule::significance, "significance", "candidates that chance scores as high"},
    RuleRow{Rule::hopeless_waves, "hopeless_waves",
            "waves that only the rest of another wave makes significant"},
    RuleRow{Rule::worthwhile_gain, "worthwhile_gain", "terms that are significant and useless"},
    RuleRow{Rule::certain_gain, "certain_gain", "terms whose gain on held-out drives is chance"},
    RuleRow{Rule::choice_held_out, "choice_held_out", "choosing a term by the data that judge it"},
    RuleRow{Rule::gain_in_most_drives, "gain_in_most_drives",
            "smooth terms that help in this drive and not in the next"},
    RuleRow{Rule::drives_not_worse, "drives_not_worse",
            "a lower residual and worse turns, straights or drives"},
    RuleRow{Rule::enough_explained, "enough_explained", "smooth terms of one covariate for an effect of two"},
    RuleRow{Rule::stricter_level, "stricter_level", "false completions of named effects"},
    RuleRow{Rule::clock_before_name, "clock_before_name", "a small delay that passes for play or slip"},
    RuleRow{Rule::unnamed_clock, "unnamed_clock", "reports of a delay of a millisecond"},
    RuleRow{Rule::names_before_smooth_terms, "names_before_smooth_terms",
            "names for what a smooth term has left"},
    RuleRow{Rule::smooth_term_before_name, "smooth_term_before_name",
            "a name of another effect that explains a part"},
    RuleRow{Rule::rest_of_a_name, "rest_of_a_name", "a second name for the rest of the first"},
    RuleRow{Rule::name_against_smooth_term, "name_against_smooth_term", "flexible names that fit anything"},
    RuleRow{Rule::nearly_all_explained, "nearly_all_explained", "right names refused for a small rest"},
    RuleRow{Rule::smooth_term_for_name, "smooth_term_for_name", "wrong names that were taken early"},
    RuleRow{Rule::exclusions, "exclusions", "a second term for what a name covers"},
    RuleRow{Rule::backward_elimination, "backward_elimination", "terms that a later term made superfluous"},
    RuleRow{Rule::few_terms, "few_terms", "models that grow with every oddity of a drive"},
    RuleRow{Rule::close_competitors, "close_competitors", "one name where the data cannot separate two"},
    RuleRow{Rule::wider_noise, "wider_noise", "robust weights that take an effect for failed matches"},
    RuleRow{Rule::larger_prior, "larger_prior", "shrinking large effects"},
    RuleRow{Rule::centred_term, "centred_term",
            "refusing terms that the drive cannot separate from slow motion"},
    RuleRow{Rule::other_shape, "other_shape", "refusing terms that were found too coarse"},
    RuleRow{Rule::best_shape, "best_shape", "shapes too coarse or too fine"},
    RuleRow{Rule::credible_shape, "credible_shape", "shapes that take a length, or that no robot has"},
    RuleRow{Rule::few_bends, "few_bends", "bends that stand for single manoeuvres"},
    RuleRow{Rule::median_threshold, "median_threshold",
            "thresholds at the end of what the drive leaves open"},
    RuleRow{Rule::hyperparameter_penalty, "hyperparameter_penalty",
            "names that win by their choice of shapes"},
    RuleRow{Rule::lidar_significance, "lidar_significance", "errors of the lidar that chance scores as high"},
    RuleRow{Rule::lidar_gain, "lidar_gain", "errors of the lidar that other scans do not show"},
    RuleRow{Rule::lidar_size, "lidar_size",
            "errors of the lidar that matter to nobody, or that no device has"},
    RuleRow{Rule::lidar_part_of_an_error, "lidar_part_of_an_error",
            "a name for a part of what the lidar does"},
    RuleRow{Rule::lidar_elimination, "lidar_elimination",
            "names of the lidar that a later one made superfluous"},
    RuleRow{Rule::range_gain, "range_gain", "errors of the ranges that stand for the map's"},
};
static_assert(kTable.size() == kRules);

}  // namespace

std::span<const RuleRow> rule_table() { return kTable; }

std::optional<Rule> rule_from(const std::string& name) {
  const auto row =
      std::find_if(kTable.begin(), kTable.end(), [&](const RuleRow& r) { return name == r.name; });
  return row == kTable.end() ? std::nullopt : std::optional(row->rule);
}

}  // namespace odomcalib::calib::selection
