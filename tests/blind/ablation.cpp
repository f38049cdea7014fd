#include "tests/blind/ablation.hpp"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "calib/selection/rules.hpp"
#include "tests/blind/blind_table.hpp"

namespace odomcalib::blind {
namespace {

using calib::selection::RuleSet;

/// Every effect is named, or flagged with its variable; of a robot without one, nothing is reported. An
/// effect that is too small to be seen may be reported or not.
bool is_right(const Trial& trial) {
  if (trial.answer.effects.empty()) return trial.named.empty() && trial.depends_on.empty();
  return !is_detectable(trial) || names_every_effect(trial) || flags_right_variable(trial);
}

}  // namespace

std::vector<Ablation> ablate(std::uint64_t campaign, unsigned number, const sim::BlindOptions& options) {
  const Examination examination = make_examination(campaign, number, options);
  calib::selection::RuleBits consulted;
  const Solution whole = solution_of(examination, RuleSet().noted_in(consulted));
  const std::string bytes = to_json(whole.calibration);
  std::vector<Ablation> all{{"", false, judge(examination, whole)}};
  for (const auto& row : calib::selection::rule_table()) {
    if (!consulted.test(static_cast<std::size_t>(row.rule))) continue;
    const Solution fewer = solution_of(examination, RuleSet().without(row.rule));
    const bool changes = to_json(fewer.calibration) != bytes;
    all.push_back({row.name, changes, changes ? judge(examination, fewer) : all.front().trial});
  }
  return all;
}

RuleSet rules_without(const std::string& rule) {
  if (rule.empty()) return {};
  const auto known = calib::selection::rule_from(rule);
  if (!known) throw std::invalid_argument("no rule of the search is called \"" + rule + "\"");
  return RuleSet().without(*known);
}

std::string to_json_line(const Ablation& ablation) {
  const Trial& trial = ablation.trial;
  return nlohmann::ordered_json{{"campaign", trial.answer.campaign},
                                {"number", trial.answer.number},
                                {"rule", ablation.rule},
                                {"changes", ablation.changes},
                                {"has_effect", !trial.answer.effects.empty()},
                                {"is_large", is_detectable(trial)},
                                {"of_the_place", belongs_to_the_place(trial)},
                                {"is_right", is_right(trial)},
                                {"named", trial.named},
                                {"depends_on", trial.depends_on},
                                {"error", trial.after.position.rms},
                                {"error_of_twin", trial.twin.position.rms},
                                {"sigmas", trial.sigmas},
                                {"seconds", trial.solve_seconds}}
      .dump();
}

}  // namespace odomcalib::blind
