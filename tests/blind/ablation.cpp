#include "tests/blind/ablation.hpp"

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "calib/selection/rules.hpp"
#include "tests/blind/blind_table.hpp"

namespace odomcalib::blind {
namespace {

using calib::selection::RuleBits;
using calib::selection::RuleSet;

/// Every effect is named, or flagged with its variable; of a robot without one, nothing is reported. An
/// effect that is too small to be seen may be reported or not.
bool is_right(const Trial& trial) {
  if (trial.answer.effects.empty()) return trial.named.empty() && trial.depends_on.empty();
  return !is_detectable(trial) || names_every_effect(trial) || flags_right_variable(trial);
}

/// Rules that are left out together, by the name of the rule or of the group.
std::vector<std::pair<const char*, RuleBits>> parts_of(AblationOf of) {
  std::vector<std::pair<const char*, RuleBits>> parts;
  if (of == AblationOf::groups)
    for (const auto& row : calib::selection::rule_group_table())
      parts.emplace_back(row.name, rules_of(row.group));
  else
    for (const auto& row : calib::selection::rule_table())
      parts.emplace_back(row.name, RuleBits().set(static_cast<std::size_t>(row.rule)));
  return parts;
}

}  // namespace

std::vector<Ablation> ablate(std::uint64_t campaign, unsigned number, const sim::BlindOptions& options,
                             Judged judged, AblationOf of) {
  const Examination examination = make_examination(campaign, number, options, judged);
  RuleBits consulted;
  const Solution whole = solution_of(examination, RuleSet().noted_in(consulted));
  const std::string bytes = to_json(whole.calibration);
  std::vector<Ablation> all{{"", false, judge(examination, whole)}};
  for (const auto& [name, rules] : parts_of(of)) {
    if ((rules & consulted).none()) continue;
    const Solution fewer = solution_of(examination, RuleSet().without(rules));
    const bool changes = to_json(fewer.calibration) != bytes;
    all.push_back({name, changes, changes ? judge(examination, fewer) : all.front().trial});
  }
  return all;
}

RuleSet rules_without(const std::vector<std::string>& names) {
  RuleSet fewer;
  for (const std::string& name : names) {
    const auto known = calib::selection::rules_named(name);
    if (!known)
      throw std::invalid_argument("no rule of the search, and no group of them, is called \"" + name +
                                  "\": --rules and --rule-groups list the names");
    fewer = fewer.without(*known);
  }
  return fewer;
}

std::string to_json_line(const Ablation& ablation) {
  const Trial& trial = ablation.trial;
  nlohmann::ordered_json json{{"campaign", trial.answer.campaign},
                              {"number", trial.answer.number},
                              {"rule", ablation.rule},
                              {"changes", ablation.changes}};
  if (!ablation.changes && !ablation.rule.empty()) return json.dump();
  json.update({{"has_effect", !trial.answer.effects.empty()},
               {"is_large", is_detectable(trial)},
               {"of_the_place", belongs_to_the_place(trial)},
               {"is_right", is_right(trial)},
               {"named", trial.named},
               {"depends_on", trial.depends_on},
               {"error", rounded(trial.after.position.rms)},
               {"error_of_twin", rounded(trial.twin.position.rms)},
               {"sigmas", {rounded(trial.sigmas[0]), rounded(trial.sigmas[1]), rounded(trial.sigmas[2])}},
               {"seconds", rounded(trial.solve_seconds)}});
  return json.dump();
}

}  // namespace odomcalib::blind
